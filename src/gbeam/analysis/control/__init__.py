"""State-space models: linearisation, reduction, the nonlinear plant."""

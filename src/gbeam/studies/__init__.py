"""Studies of many runs of one scenario: sweeps, sensitivities, fits, optima and shaped commands."""

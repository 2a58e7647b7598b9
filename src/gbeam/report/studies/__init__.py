"""Studies of many runs in words and JSON: sweeps, sensitivities, fits, optima."""

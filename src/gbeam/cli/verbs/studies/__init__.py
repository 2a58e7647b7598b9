"""Verbs of many runs: sweeps, sensitivities, fits, optima."""

"""The equations of motion: D'Alembert's sum over particles, complete or kept to first order in the coordinates."""

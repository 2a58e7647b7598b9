"""The equations of motion: D'Alembert's sum over particles, complete, or with the places' polynomial kept to first order."""

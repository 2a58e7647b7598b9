"""Response over time in one environment, with its error estimate, outcome and section forces."""

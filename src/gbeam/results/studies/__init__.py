"""Results of many runs of one scenario."""

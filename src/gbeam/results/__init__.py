"""Frozen records of arrays and words: what every analysis returns. No model, solver or computation inside."""

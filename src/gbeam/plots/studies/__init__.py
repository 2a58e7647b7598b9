"""Figures of what many runs say together."""

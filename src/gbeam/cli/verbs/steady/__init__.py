"""Verbs of one steady state: rest, modes, critical speeds, linear models."""

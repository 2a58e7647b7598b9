"""Errors of results: what the complete equations with more shapes say at the solution."""

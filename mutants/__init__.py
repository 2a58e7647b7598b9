"""Deliberate errors in the physics, each of which the tests have to catch: ``make mutants``."""

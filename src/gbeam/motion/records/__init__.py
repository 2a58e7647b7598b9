"""Measured flights: one reader per kind of file, a table of named columns, checks by physics, a record to fly."""

"""Solvers without a beam: banded systems, eigenvalues, roots, a bounded search, an interior-point method."""

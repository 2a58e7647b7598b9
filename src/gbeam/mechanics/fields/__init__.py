"""Displacement fields r(x; q) along the beam: shape functions, the projected field, the exact one, and a sprung root."""

"""Displacement fields r(x; q) along the beam: shapes, the projected field, the exact one, a sprung root."""

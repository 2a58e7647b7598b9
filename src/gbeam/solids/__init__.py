"""Solids: a mesh, imported matrices or a rigid specimen in place of a beam."""

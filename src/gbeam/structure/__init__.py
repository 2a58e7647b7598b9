"""Flexible things: material, section, beam, bodies on the beam, springs at its root, loads. Plain checked data, SI."""

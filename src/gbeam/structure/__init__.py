"""Flexible things: material, section, beam, bodies on the beam, springs at its root, loads. Plain checked data, SI."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

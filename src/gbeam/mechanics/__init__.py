"""From a structure to its equations: shapes, displacement fields, energies, virtual work, equations, models."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

"""Arrays: NumPy's, or JAX's where something is traced; records of them; JAX's settings."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

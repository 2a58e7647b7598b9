"""One folder per family of questions. Reads objects, returns records; nothing here opens a file, draws or prints."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

"""Every result in words for people, as `text` says them. `facts` is the JSON, with the sentences of these words."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

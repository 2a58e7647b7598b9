"""Figures of results, each described once: `plots` draws them with Matplotlib, and a report's page shows the same.

`registry` knows which figures a result has. A figure reads results only, never a model, and draws nothing.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

"""Scenario files: text -> validated scenario -> the objects of the core.

text/ reads quantities, places and overrides; schema/ declares the tables; load validates. Build makes the objects;
explain and placing put every error at its line. Template is for those who write scenarios.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

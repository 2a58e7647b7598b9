"""Version of gbeam."""

__version__ = "0.3.0"

"""gbeam: how a flexible beam responds while its base moves a lot.

A structure is particles with places r(q) and a strain energy; a model says where the places' expansion ends. The rooms,
from the outside in: cli, scenario and report, plots, io; analysis; mechanics, structure, motion, integrate; results and
numerics. Everything that the command line does is a function of this module.

A name is imported when it is first used, and with it what it needs: importing gbeam is light.
"""

from __future__ import annotations

import lazy_loader

from gbeam import doors
from gbeam.results.doors import bind
from gbeam.version import __version__ as __version__

bind(doors)

# Every public name, and the module it is in: as the stub has them, which type checkers read.
_public, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

# Former names, which warn until the next version.
_FORMER = {"commands": "axis_commands", "shape": "shape_hub_command"}


def __getattr__(name: str) -> object:
    if name in _FORMER:
        import warnings

        warnings.warn(f"gbeam.{name} is now gbeam.{_FORMER[name]}", DeprecationWarning, stacklevel=2)
        return _public(_FORMER[name])
    if name not in __all__:
        raise AttributeError(f"module 'gbeam' has no attribute {name!r}")
    return _public(name)

"""Kinds of bodies: each is a file of this folder, with its table and its builder in a :class:`BodyKind` named BODY."""

from __future__ import annotations

from importlib import import_module
from pkgutil import iter_modules

from gbeam.scenario.bodies.common import BodyKind

_MODULES = (import_module(f"{__name__}.{each.name}") for each in iter_modules(__path__))
_EVERY: list[BodyKind] = [module.BODY for module in _MODULES if hasattr(module, "BODY")]
BODIES: dict[str, BodyKind] = {each.name: each for each in _EVERY}
OF_TABLE: dict[type, BodyKind] = {each.table: each for each in _EVERY}

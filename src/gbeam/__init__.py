"""gbeam: how a flexible beam responds while its base moves a lot.

A model is a displacement field with a truncation of one kinetic energy; its equations come by differentiation.
The numerical names load JAX when they are first used, so that importing gbeam is light.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

from gbeam.beam import Beam, Material, PointMass
from gbeam.errors import ComputationError, GbeamError, InputError
from gbeam.loads import Load
from gbeam.root import Root
from gbeam.section import Section

if TYPE_CHECKING:
    from gbeam.analysis import (
        Gauge,
        StateSpace,
        balance,
        buckling_acceleration,
        campbell,
        compare,
        compare_models,
        critical_speed,
        critical_speed_map,
        deflect,
        equilibrium,
        linearize,
        modes,
        nonlinear_system,
        respond,
        study,
        truncate,
    )
    from gbeam.case import Case, ResponseSettings
    from gbeam.model import Model, Structure, assemble
    from gbeam.motion import (
        Centrifuge,
        Flight,
        HubRate,
        HubTorque,
        Sine,
        SmoothStep,
        build_target,
        constant,
        read_record,
        smoothed,
        stack,
        table,
        trapezoid,
    )
    from gbeam.results import Response, Study
    from gbeam.results_comparison import Comparison
    from gbeam.scenario import build, load  # type: ignore[no-redef]  # modules there have the same names

__version__ = "0.1.0"

_HOMES = {
    "gbeam.analysis": (
        "Gauge",
        "StateSpace",
        "balance",
        "buckling_acceleration",
        "campbell",
        "compare",
        "compare_models",
        "critical_load",
        "critical_speed",
        "critical_speed_map",
        "deflect",
        "equilibrium",
        "linearize",
        "modes",
        "nonlinear_system",
        "respond",
        "study",
        "truncate",
    ),
    "gbeam.case": ("Case", "ResponseSettings"),
    "gbeam.model": ("Model", "Structure", "assemble"),
    "gbeam.motion": (
        "Centrifuge",
        "Flight",
        "HubRate",
        "HubTorque",
        "Sine",
        "SmoothStep",
        "build_target",
        "constant",
        "read_record",
        "smoothed",
        "stack",
        "table",
        "trapezoid",
    ),
    "gbeam.results": ("Comparison", "Response", "Study"),
    "gbeam.scenario": ("build", "load"),
}
_HOME = {name: module for module, names in _HOMES.items() for name in names}

__all__ = [
    "Beam",
    "Case",
    "Centrifuge",
    "Comparison",
    "ComputationError",
    "Flight",
    "Gauge",
    "GbeamError",
    "HubRate",
    "HubTorque",
    "InputError",
    "Load",
    "Material",
    "Model",
    "PointMass",
    "Response",
    "ResponseSettings",
    "Root",
    "Section",
    "Sine",
    "SmoothStep",
    "StateSpace",
    "Structure",
    "Study",
    "assemble",
    "balance",
    "buckling_acceleration",
    "build",
    "build_target",
    "campbell",
    "compare",
    "compare_models",
    "constant",
    "critical_load",
    "critical_speed",
    "critical_speed_map",
    "deflect",
    "equilibrium",
    "linearize",
    "load",
    "modes",
    "nonlinear_system",
    "read_record",
    "respond",
    "smoothed",
    "stack",
    "study",
    "table",
    "trapezoid",
    "truncate",
]


def __getattr__(name: str) -> object:
    if name in _HOME:
        return getattr(import_module(_HOME[name]), name)
    raise AttributeError(f"module 'gbeam' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)

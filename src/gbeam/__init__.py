"""gbeam: how a flexible beam responds while its base moves a lot.

A model is a displacement field with a truncation of one kinetic energy; its equations come by differentiation.
The numerical names load JAX when they are first used, so that importing gbeam is light.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

from gbeam.errors import ComputationError, GbeamError, InputError
from gbeam.structure.beam import Beam
from gbeam.structure.bodies import PointMass
from gbeam.structure.material import Material
from gbeam.structure.loads import Load
from gbeam.structure.section import Section
from gbeam.structure.support import Root

if TYPE_CHECKING:
    from gbeam.analysis.control.linearization import linearize
    from gbeam.analysis.control.nonlinear import nonlinear_system
    from gbeam.analysis.control.reduction import balanced_truncation, modal_truncation
    from gbeam.results.state_space import Gauge, StateSpace
    from gbeam.analysis.equilibrium.equilibrium import solve_equilibrium
    from gbeam.analysis.equilibrium.static import static
    from gbeam.analysis.imitation.comparison import compare
    from gbeam.analysis.response.simulation import simulate
    from gbeam.analysis.response.settings import ResponseSettings
    from gbeam.analysis.study.case import Case
    from gbeam.analysis.study.model_study import compare_models
    from gbeam.analysis.study.study import study
    from gbeam.analysis.vibration.campbell import campbell
    from gbeam.analysis.vibration.modal import modes
    from gbeam.analysis.vibration.stability import buckling_acceleration, critical_speed, critical_speed_map
    from gbeam.mechanics.assembly import assemble
    from gbeam.mechanics.models import Model
    from gbeam.mechanics.structure import Structure
    from gbeam.motion import (
        Centrifuge,
        Flight,
        Hub,
        Sine,
        SmoothStep,
        build_target,
        constant,
        machines,
        read_record,
        smoothed,
        tabulated,
        trapezoid,
        vector,
    )
    from gbeam.results.comparison import Comparison
    from gbeam.results.response import Response, Study
    from gbeam.scenario import build, load  # type: ignore[no-redef]  # modules there have the same names

__version__ = "0.1.0"

_HOMES = {
    "gbeam.analysis.control.linearization": (
        "Gauge",
        "linearize",
    ),
    "gbeam.analysis.control.nonlinear": ("nonlinear_system",),
    "gbeam.analysis.control.reduction": (
        "balanced_truncation",
        "modal_truncation",
    ),
    "gbeam.results.state_space": ("Gauge", "StateSpace"),
    "gbeam.analysis.equilibrium.equilibrium": ("solve_equilibrium",),
    "gbeam.analysis.equilibrium.static": ("static",),
    "gbeam.analysis.imitation.comparison": ("compare",),
    "gbeam.analysis.response.simulation": ("simulate",),
    "gbeam.analysis.study.model_study": ("compare_models",),
    "gbeam.analysis.study.study": ("study",),
    "gbeam.analysis.vibration.campbell": ("campbell",),
    "gbeam.analysis.vibration.modal": ("modes",),
    "gbeam.analysis.vibration.stability": (
        "buckling_acceleration",
        "critical_load",
        "critical_speed",
        "critical_speed_map",
    ),
    "gbeam.analysis.response.settings": ("ResponseSettings",),
    "gbeam.analysis.study.case": ("Case",),
    "gbeam.mechanics.assembly": ("assemble",),
    "gbeam.mechanics.models": ("Model",),
    "gbeam.mechanics.structure": ("Structure",),
    "gbeam.motion": (
        "Centrifuge",
        "Flight",
        "Hub",
        "Sine",
        "SmoothStep",
        "build_target",
        "constant",
        "machines",
        "read_record",
        "smoothed",
        "tabulated",
        "trapezoid",
        "vector",
    ),
    "gbeam.results.response": ("Comparison", "Response", "Study"),
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
    "Hub",
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
    "balanced_truncation",
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
    "solve_equilibrium",
    "linearize",
    "load",
    "machines",
    "modal_truncation",
    "modes",
    "nonlinear_system",
    "read_record",
    "simulate",
    "smoothed",
    "static",
    "study",
    "tabulated",
    "trapezoid",
    "vector",
]


def __getattr__(name: str) -> object:
    if name in _HOME:
        return getattr(import_module(_HOME[name]), name)
    raise AttributeError(f"module 'gbeam' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)

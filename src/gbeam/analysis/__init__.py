"""One file per question: response over time, equilibrium, comparison of two responses, a whole case."""

from gbeam.analysis.campbell_diagram import campbell
from gbeam.analysis.case_study import structure_of, study
from gbeam.analysis.comparison import compare
from gbeam.analysis.deflection import deflect
from gbeam.analysis.linearization import Gauge, linearize
from gbeam.analysis.modal import modes
from gbeam.analysis.model_study import compare_models
from gbeam.analysis.nonlinear_control import nonlinear_system
from gbeam.analysis.reduction import balance, truncate
from gbeam.analysis.response import respond
from gbeam.analysis.stability import buckling_acceleration, critical_load, critical_speed, critical_speed_map
from gbeam.analysis.state_space import StateSpace
from gbeam.analysis.static import equilibrium

__all__ = [
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
    "structure_of",
    "study",
    "truncate",
]

"""Structural time integration; knows nothing of beams.

A system says which acceleration makes its equations hold; a scheme turns that into steps; the driver runs them in
chunks of fixed length, so that one compiled program serves every duration and step.
"""

from gbeam.integrate.adaptive import integrate_adaptively
from gbeam.integrate.driver import Trajectory, evaluate, integrate
from gbeam.integrate.gauss import Gauss4
from gbeam.integrate.stepper import OneStep, generalized_alpha, hht, newmark
from gbeam.integrate.system import LinearSystem, NonlinearSystem, State, System

__all__ = [
    "Gauss4",
    "LinearSystem",
    "NonlinearSystem",
    "OneStep",
    "State",
    "System",
    "Trajectory",
    "evaluate",
    "generalized_alpha",
    "hht",
    "integrate",
    "integrate_adaptively",
    "newmark",
]

"""gbeam: how a flexible beam responds while its base moves a lot.

A structure is particles with places r(q) and a strain energy; a model says where the places' expansion ends. The rooms,
from the outside in: cli, scenario and report, plots, io; analysis; mechanics, structure, motion, integrate; results and
numerics. Everything that the command line does is a function of this module.

A name is imported when it is first used, and with it what it needs: importing gbeam is light.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:  # the same names as in _HOME: tests/test_public.py
    from gbeam.analysis.case import Case as Case
    from gbeam.analysis.case import SpecimenCase as SpecimenCase
    from gbeam.analysis.case import SystemCase as SystemCase
    from gbeam.analysis.case import describe as describe
    from gbeam.analysis.control.linearization import linearize as linearize
    from gbeam.analysis.control.linearization import nonlinear_system as nonlinear_system
    from gbeam.analysis.control.linearization import surface_gauges as surface_gauges
    from gbeam.analysis.control.reduction import balanced_truncation as balanced_truncation
    from gbeam.analysis.control.reduction import modal_truncation as modal_truncation
    from gbeam.analysis.control.shaping import shape_command as shape_command
    from gbeam.analysis.environments import study as study
    from gbeam.analysis.imitation.comparison import compare as compare
    from gbeam.analysis.imitation.place import place as place
    from gbeam.analysis.imitation.place_measures import Choice as Choice
    from gbeam.analysis.imitation.place_measures import choice_of as choice_of
    from gbeam.analysis.imitation.plan import axis_commands as axis_commands
    from gbeam.analysis.imitation.plan import plan as plan
    from gbeam.analysis.model_study import compare_models as compare_models
    from gbeam.analysis.response.batch import simulate_batch as simulate_batch
    from gbeam.analysis.response.problem import Initial as Initial
    from gbeam.analysis.response.settings import ResponseSettings as ResponseSettings
    from gbeam.analysis.response.simulation import simulate as simulate
    from gbeam.analysis.steady.campbell import campbell as campbell
    from gbeam.analysis.steady.equilibrium import solve_equilibrium as solve_equilibrium
    from gbeam.analysis.steady.modal import modes as modes
    from gbeam.analysis.steady.stability import buckling_acceleration as buckling_acceleration
    from gbeam.analysis.steady.stability import critical_load as critical_load
    from gbeam.analysis.steady.stability import critical_speed as critical_speed
    from gbeam.analysis.steady.stability import critical_speed_map as critical_speed_map
    from gbeam.analysis.steady.static import static as static
    from gbeam.errors import ComputationError as ComputationError
    from gbeam.errors import GbeamError as GbeamError
    from gbeam.errors import InputError as InputError
    from gbeam.io.models.registry import read_matrix as read_matrix
    from gbeam.mechanics.assembly import assemble as assemble
    from gbeam.mechanics.models import Model as Model
    from gbeam.mechanics.structure import Structure as Structure
    from gbeam.mechanics.tree.control import Feedback as Feedback
    from gbeam.mechanics.tree.joints import Joint as Joint
    from gbeam.mechanics.tree.system import Place as Place
    from gbeam.mechanics.tree.system import PointForce as PointForce
    from gbeam.mechanics.tree.system import RigidBody as RigidBody
    from gbeam.mechanics.tree.system import System as System
    from gbeam.motion.bases.flight import Flight as Flight
    from gbeam.motion.bases.hub import Hub as Hub
    from gbeam.motion.centrifuge.centrifuge import Centrifuge as Centrifuge
    from gbeam.motion.centrifuge.limits import AxisLimit as AxisLimit
    from gbeam.motion.centrifuge.limits import MachineLimits as MachineLimits
    from gbeam.motion.centrifuge.limits import machines as machines
    from gbeam.motion.centrifuge.target.build import build_target as build_target
    from gbeam.motion.profiles.combine import Sum as Sum
    from gbeam.motion.profiles.combine import vector as vector
    from gbeam.motion.profiles.piecewise import constant as constant
    from gbeam.motion.profiles.piecewise import tabulated as tabulated
    from gbeam.motion.profiles.piecewise import trapezoid as trapezoid
    from gbeam.motion.profiles.profile import smoothed as smoothed
    from gbeam.motion.profiles.pulse import Sine as Sine
    from gbeam.motion.profiles.pulse import SmoothStep as SmoothStep
    from gbeam.motion.profiles.pulse import SplineProfile as SplineProfile
    from gbeam.motion.records.record import read_record as read_record
    from gbeam.results.cases import Sensitivity as Sensitivity
    from gbeam.results.cases import Sweep as Sweep
    from gbeam.results.imitation.comparison import Comparison as Comparison
    from gbeam.results.response import Response as Response
    from gbeam.results.response import Sensor as Sensor
    from gbeam.results.searches import Fit as Fit
    from gbeam.results.searches import Optimum as Optimum
    from gbeam.results.searches import ShapedCommand as ShapedCommand
    from gbeam.results.state_space import Gauge as Gauge
    from gbeam.results.state_space import StateSpace as StateSpace
    from gbeam.results.study import Study as Study
    from gbeam.results.study import SystemStudy as SystemStudy
    from gbeam.results.system import SystemModes as SystemModes
    from gbeam.results.system import SystemResponse as SystemResponse
    from gbeam.results.system import SystemRest as SystemRest
    from gbeam.scenario.build import read_scenario as read_scenario
    from gbeam.scenario.rerun import rerun as rerun
    from gbeam.solids.imported import ImportedModel as ImportedModel
    from gbeam.solids.mesh import SolidMesh as SolidMesh
    from gbeam.solids.modal_test import ModalTest as ModalTest
    from gbeam.solids.model import SolidModel as SolidModel
    from gbeam.solids.rigid import RigidSpecimen as RigidSpecimen
    from gbeam.solids.standard_input import read_sid as read_sid
    from gbeam.structure.attachments import Load as Load
    from gbeam.structure.attachments import Point as Point
    from gbeam.structure.attachments import PointMass as PointMass
    from gbeam.structure.attachments import Root as Root
    from gbeam.structure.beam import Beam as Beam
    from gbeam.structure.line import Line as Line
    from gbeam.structure.material import Material as Material
    from gbeam.structure.material import Orthotropic as Orthotropic
    from gbeam.structure.section import Section as Section
    from gbeam.studies.fit import fit as fit
    from gbeam.studies.optimise import optimise as optimise
    from gbeam.studies.sensitivity import sensitivity as sensitivity
    from gbeam.studies.shape import shape_hub_command as shape_hub_command
    from gbeam.studies.sweep import sweep as sweep

__version__ = "0.2.0"

# Every public name, and the module it is in.
_HOME = {
    "Feedback": "mechanics.tree.control",
    "Joint": "mechanics.tree.joints",
    "Place": "mechanics.tree.system",
    "PointForce": "mechanics.tree.system",
    "RigidBody": "mechanics.tree.system",
    "System": "mechanics.tree.system",
    "SpecimenCase": "analysis.case",
    "SystemCase": "analysis.case",
    "SystemStudy": "results.study",
    "SystemModes": "results.system",
    "SystemResponse": "results.system",
    "SystemRest": "results.system",
    "AxisLimit": "motion.centrifuge.limits",
    "Beam": "structure.beam",
    "Case": "analysis.case",
    "Centrifuge": "motion.centrifuge.centrifuge",
    "Choice": "analysis.imitation.place_measures",
    "Comparison": "results.imitation.comparison",
    "ComputationError": "errors",
    "Fit": "results.searches",
    "Flight": "motion.bases.flight",
    "Gauge": "results.state_space",
    "GbeamError": "errors",
    "Hub": "motion.bases.hub",
    "Initial": "analysis.response.problem",
    "ImportedModel": "solids.imported",
    "InputError": "errors",
    "Line": "structure.line",
    "Load": "structure.attachments",
    "MachineLimits": "motion.centrifuge.limits",
    "Material": "structure.material",
    "ModalTest": "solids.modal_test",
    "Model": "mechanics.models",
    "Optimum": "results.searches",
    "Orthotropic": "structure.material",
    "Point": "structure.attachments",
    "PointMass": "structure.attachments",
    "Response": "results.response",
    "ResponseSettings": "analysis.response.settings",
    "RigidSpecimen": "solids.rigid",
    "Root": "structure.attachments",
    "Section": "structure.section",
    "Sensitivity": "results.cases",
    "ShapedCommand": "results.searches",
    "Sensor": "results.response",
    "Sine": "motion.profiles.pulse",
    "SmoothStep": "motion.profiles.pulse",
    "SolidMesh": "solids.mesh",
    "SolidModel": "solids.model",
    "SplineProfile": "motion.profiles.pulse",
    "StateSpace": "results.state_space",
    "Structure": "mechanics.structure",
    "Study": "results.study",
    "Sweep": "results.cases",
    "Sum": "motion.profiles.combine",
    "assemble": "mechanics.assembly",
    "axis_commands": "analysis.imitation.plan",
    "balanced_truncation": "analysis.control.reduction",
    "buckling_acceleration": "analysis.steady.stability",
    "build_target": "motion.centrifuge.target.build",
    "campbell": "analysis.steady.campbell",
    "choice_of": "analysis.imitation.place_measures",
    "compare": "analysis.imitation.comparison",
    "compare_models": "analysis.model_study",
    "constant": "motion.profiles.piecewise",
    "critical_load": "analysis.steady.stability",
    "critical_speed": "analysis.steady.stability",
    "critical_speed_map": "analysis.steady.stability",
    "describe": "analysis.case",
    "fit": "studies.fit",
    "linearize": "analysis.control.linearization",
    "machines": "motion.centrifuge.limits",
    "modal_truncation": "analysis.control.reduction",
    "modes": "analysis.steady.modal",
    "nonlinear_system": "analysis.control.linearization",
    "optimise": "studies.optimise",
    "place": "analysis.imitation.place",
    "plan": "analysis.imitation.plan",
    "read_matrix": "io.models.registry",
    "read_record": "motion.records.record",
    "read_scenario": "scenario.build",
    "read_sid": "solids.standard_input",
    "rerun": "scenario.rerun",
    "sensitivity": "studies.sensitivity",
    "shape_command": "analysis.control.shaping",
    "shape_hub_command": "studies.shape",
    "simulate": "analysis.response.simulation",
    "simulate_batch": "analysis.response.batch",
    "smoothed": "motion.profiles.profile",
    "solve_equilibrium": "analysis.steady.equilibrium",
    "static": "analysis.steady.static",
    "study": "analysis.environments",
    "surface_gauges": "analysis.control.linearization",
    "sweep": "studies.sweep",
    "tabulated": "motion.profiles.piecewise",
    "trapezoid": "motion.profiles.piecewise",
    "vector": "motion.profiles.combine",
}

# Former names, which warn until the next version.
_FORMER = {"commands": "axis_commands", "shape": "shape_hub_command"}

__all__ = sorted(_HOME)


def __getattr__(name: str) -> object:
    if name in _FORMER:
        import warnings

        warnings.warn(f"gbeam.{name} is now gbeam.{_FORMER[name]}", DeprecationWarning, stacklevel=2)
        return globals().get(_FORMER[name]) or __getattr__(_FORMER[name])
    if name not in _HOME:
        raise AttributeError(f"module 'gbeam' has no attribute {name!r}")
    value = getattr(import_module(f"gbeam.{_HOME[name]}"), name)
    globals()[name] = value  # from now on it needs no look-up
    return value


def __dir__() -> list[str]:
    return __all__

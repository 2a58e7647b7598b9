"""Scenario files: text -> validated scenario -> the objects of the core.

units read "300 mm"; schema says what may be written; locate, explain and diagnostics say what is wrong
and where; load puts them together; build makes the objects; template is for those
who write scenarios.
"""

from gbeam.scenario.build import build, build_machines
from gbeam.scenario.explain import placed
from gbeam.scenario.load import load, load_environments, loads
from gbeam.scenario.schema import Environments, Scenario
from gbeam.scenario.template import json_schema, template
from gbeam.scenario.text.diagnostics import Diagnostic, ScenarioError
from gbeam.scenario.text.units import UnitError, argument, quantity

__all__ = [
    "Diagnostic",
    "Environments",
    "Scenario",
    "ScenarioError",
    "UnitError",
    "argument",
    "build",
    "build_machines",
    "json_schema",
    "load",
    "load_environments",
    "loads",
    "placed",
    "quantity",
    "template",
]

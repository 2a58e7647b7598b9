"""Scenario files: text -> validated scenario -> the objects of the core.

text/ reads quantities, places and overrides; schema/ declares the tables; load validates; build makes the objects;
explain and placing put every error at its line; template is for those who write scenarios.
"""

from gbeam.guards.units import UnitError, argument, quantity
from gbeam.scenario.build import build, build_extent, build_machines, read_scenario
from gbeam.scenario.load import load, load_environments, loads, placed, provenance
from gbeam.scenario.schema import Environments, Scenario
from gbeam.scenario.template import json_schema, template
from gbeam.scenario.text.diagnostics import Diagnostic, ScenarioError

__all__ = [
    "Diagnostic",
    "Environments",
    "Scenario",
    "ScenarioError",
    "UnitError",
    "argument",
    "build",
    "build_extent",
    "build_machines",
    "json_schema",
    "load",
    "load_environments",
    "loads",
    "placed",
    "provenance",
    "quantity",
    "read_scenario",
    "template",
]

"""Scenario files: text -> validated scenario -> the objects of the core.

text/ reads quantities, places and overrides; schema/ declares the tables; load validates; build makes the objects;
explain and placing put every error at its line; template is for those who write scenarios.
"""

from gbeam.scenario.build import build as build
from gbeam.scenario.build import build_machines as build_machines
from gbeam.scenario.build import build_specimen as build_specimen
from gbeam.scenario.build import read_scenario as read_scenario
from gbeam.scenario.load import load as load
from gbeam.scenario.load import load_environments as load_environments
from gbeam.scenario.load import loads as loads
from gbeam.scenario.load import placed as placed
from gbeam.scenario.load import provenance as provenance
from gbeam.scenario.schema import Scenario as Scenario
from gbeam.scenario.template import json_schema as json_schema
from gbeam.scenario.template import template as template
from gbeam.scenario.text.diagnostics import Diagnostic as Diagnostic
from gbeam.scenario.text.diagnostics import ScenarioError as ScenarioError

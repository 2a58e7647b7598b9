"""Values that are left out are the same in a file and in Python."""

from __future__ import annotations

import inspect
from pathlib import Path

import gbeam as gb
from gbeam.scenario import Response as ResponseTable

SCENARIO = """
[beam]
length = "300 mm"
section = { shape = "rectangle", width = "20 mm", thickness = "4 mm" }
material = { density = 2700, youngs_modulus = "70 GPa" }
damping_ratio = 0.01
[model]
kind = "FOAM"
modes = { axial = 0, y = 1, z = 1 }
[motion.flight]
kind = "flight"
acceleration = { z = { profile = "trapezoid", level = 78.5, jerk = 39.2, start = 1, hold = 1 } }
[motion.centrifuge]
kind = "centrifuge"
tracks = "flight"
machine = "specimen-3.3m"
control_point = "200 mm"
gravity = false
[response]
duration = "6 s"
"""


def test_what_is_left_out_of_a_response_is_left_out_in_both_or_the_same() -> None:
    """Tables of signatures have their defaults; that of a response is written by hand."""
    arguments, fields = inspect.signature(gb.ResponseSettings).parameters, ResponseTable.model_fields
    assert arguments.keys() & fields.keys()
    for name in arguments.keys() & fields.keys():
        field = fields[name]
        if field.default is not None and field.default_factory is None:  # a key without a default is not passed on
            assert arguments[name].default == (None if field.default == "auto" else field.default), name


def test_a_machine_of_a_file_is_that_of_python(tmp_path: Path) -> None:
    path = tmp_path / "scenario.toml"
    path.write_text(SCENARIO, encoding="utf-8")
    of_file = gb.read_scenario(path).motions["centrifuge"]
    flight = gb.Flight(z=gb.trapezoid(78.5, jerk=39.2, start=1, hold=1))
    of_python = gb.Centrifuge(flight, control_point=0.2, limits=gb.machines["specimen-3.3m"], gravity=False)
    assert isinstance(of_file, gb.Centrifuge)
    for name in ("geometry", "control_point", "method", "ends", "idle", "smoothing", "clip", "ease"):
        assert repr(getattr(of_file, name)) == repr(getattr(of_python, name)), name

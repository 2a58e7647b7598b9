"""A scenario that computes in a second, and the command line called as a user does, in this process."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from gbeam.cli import main

FAST = """\
title = "fast"
[beam]
length = "300 mm"
section = { shape = "rectangle", width = "20 mm", thickness = "4 mm" }
material = { density = "2700 kg/m^3", youngs_modulus = "70 GPa" }
damping_ratio = 0.01
[model]
kind = "FOAM"
modes = { axial = 0, y = 1, z = 1 }
[motion.flight]
kind = "flight"
acceleration = { z = { profile = "constant", level = "6 g" } }
[motion.spin]
kind = "centrifuge"
tracks = "flight"
arm = "3.3 m"
control_point = "150 mm"
inverse = "flat"
gravity = false
[response]
duration = "0.5 s"
"""

HUB = """\
title = "hub"
[beam]
length = "8 m"
section = { area = "7.2968e-5 m^2", inertia_y = "8.2189e-9 m^4", inertia_z = "8.2189e-9 m^4" }
material = { density = "2766.7 kg/m^3", youngs_modulus = "6.8952e10 Pa" }
damping_ratio = 0
[model]
kind = "FOAM"
modes = { axial = 1, y = 1, z = 0 }
[motion.slew]
kind = "hub"
radius = "0.5 m"
inertia = "200 kg m^2"
torque = { profile = "sine", amplitude = "50 N m", duration = "2 s" }
[response]
duration = "4 s"
residual_from = "2 s"
"""


@dataclass(frozen=True)
class Answer:
    """What a call of the command line gave."""

    status: int
    out: str
    err: str

    @property
    def json(self) -> Any:
        """Stdout as the one JSON object that it has to be."""
        return json.loads(self.out)


@pytest.fixture
def fast(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A flight and a centrifuge in a file, in the current folder."""
    monkeypatch.chdir(tmp_path)
    file = tmp_path / "fast.toml"
    file.write_text(FAST)
    return file


@pytest.fixture
def hub(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A free hub in a file, in the current folder."""
    monkeypatch.chdir(tmp_path)
    file = tmp_path / "hub.toml"
    file.write_text(HUB)
    return file


@pytest.fixture
def gbeam(capsys: pytest.CaptureFixture[str]) -> Callable[..., Answer]:
    """Call the command line with its arguments."""

    def call(*arguments: object) -> Answer:
        status = main([str(argument) for argument in arguments])
        captured = capsys.readouterr()
        assert "Traceback" not in captured.err
        return Answer(status, captured.out, captured.err)

    return call

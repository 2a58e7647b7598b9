"""One scenario, written otherwise: in other units, with its keys in another order, mirrored."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gbeam import read_scenario, simulate

from .strategies import few

# Units by the definitions of the International System and of the yard and pound agreement of 1959, written here afresh.
INCH, POUND, G = 0.0254, 0.45359237, 9.80665
SIZES: dict[str, dict[str, float]] = {
    "length": {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "in": INCH, "ft": 12 * INCH, "um": 1e-6},
    "mass": {"kg": 1.0, "g": 1e-3, "lb": POUND},
    "density": {"kg/m^3": 1.0, "g/cm^3": 1e3, "lb/ft^3": POUND / (12 * INCH) ** 3},
    "pressure": {"Pa": 1.0, "GPa": 1e9, "MPa": 1e6, "psi": POUND * G / INCH**2, "N/mm^2": 1e6},
    "acceleration": {"m/s^2": 1.0, "g": G, "ft/s^2": 12 * INCH, "mm/s^2": 1e-3},
    "jerk": {"m/s^3": 1.0, "g/s": G, "in/s^3": INCH},
    "time": {"s": 1.0, "ms": 1e-3, "min": 60.0},
    "force": {"N": 1.0, "lbf": POUND * G, "kN": 1e3},
    "torque": {"N m": 1.0, "lbf in": POUND * G * INCH, "kN m": 1e3},
}
# key: kind, value in SI
VALUES = {
    "length": ("length", 0.3),
    "width": ("length", 0.02),
    "thickness": ("length", 0.004),
    "density": ("density", 2700.0),
    "youngs_modulus": ("pressure", 7e10),
    "at": ("length", 0.2),
    "mass": ("mass", 0.05),
    "offset": ("length", 0.01),
    "load_at": ("length", 0.25),
    "force": ("force", 3.0),
    "moment": ("torque", 0.2),
    "level": ("acceleration", 30.0),
    "jerk": ("jerk", 300.0),
    "start": ("time", 0.02),
    "hold": ("time", 0.05),
    "duration": ("time", 0.2),
    "step": ("time", 1e-3),
}


def scenario(units: dict[str, str], order: list[int], mirror: float = 1.0) -> str:
    """The text, each value in its unit, tables and keys in some order."""

    def q(key: str, sign: float = 1.0) -> str:
        kind, value = VALUES[key]
        return f'"{sign * value / SIZES[kind][units[key]]!r} {units[key]}"'

    def shuffled(lines: list[str]) -> list[str]:
        return [lines[i % len(lines)] for i in np.argsort([order[k % len(order)] for k in range(len(lines))])]

    profile = ['profile = "trapezoid"', f"level = {q('level')}", f"jerk = {q('jerk')}", f"start = {q('start')}",
               f"hold = {q('hold')}"]  # fmt: skip
    section = ['shape = "rectangle"', f"width = {q('width')}", f"thickness = {q('thickness')}"]
    body = [f"at = {q('at')}", f"mass = {q('mass')}", f"offset = [0, {q('offset', mirror)}, 0]"]
    force = f"{{ y = {q('force', mirror)}, z = {q('force')} }}"
    load = [f"at = {q('load_at')}", f"force = {force}", f"moment = {{ z = {q('moment', mirror)} }}"]
    tables = [
        ["[beam]", *shuffled([
            f"length = {q('length')}",
            "section = { " + ", ".join(shuffled(section)) + " }",
            "material = { " + ", ".join(shuffled([f"density = {q('density')}",
                                                  f"youngs_modulus = {q('youngs_modulus')}"])) + " }",
            "damping_ratio = 0.01",
            "masses = [ { " + ", ".join(shuffled(body)) + " } ]",
            "loads = [ { " + ", ".join(shuffled(load)) + " } ]",
        ])],
        ["[model]", *shuffled(['kind = "FOAM"', "modes = { axial = 1, y = 2, z = 2 }"])],
        ["[motion.flight]", *shuffled(['kind = "flight"',
                                       "acceleration = { z = { " + ", ".join(shuffled(profile)) + " } }"])],
        ["[response]", *shuffled([f"duration = {q('duration')}", f"step = {q('step')}"])],
    ]  # fmt: skip
    order_of_tables = np.argsort([order[-1 - k] for k in range(4)])
    return "\n".join("\n".join(tables[i]) for i in order_of_tables) + "\n"


def tip(folder: Path, text: str) -> np.ndarray:
    """Tip in flight, m."""
    path = folder / "s.toml"
    path.write_text(text, encoding="utf-8")
    case: Any = read_scenario(path)
    (motion,) = case.motions.values()
    return simulate(case.subject, motion, replace(case.response, estimate=False)).tip


PLAIN = {key: next(iter(SIZES[kind])) for key, (kind, _) in VALUES.items()}
ORDER = list(range(12))


@pytest.fixture(scope="module")
def reference(tmp_path_factory: pytest.TempPathFactory) -> np.ndarray:
    return tip(tmp_path_factory.mktemp("plain"), scenario(PLAIN, ORDER))


@few
@given(units=st.fixed_dictionaries({key: st.sampled_from(sorted(SIZES[kind])) for key, (kind, _) in VALUES.items()}))
def test_other_units(reference: np.ndarray, tmp_path_factory: pytest.TempPathFactory, units: dict[str, str]) -> None:
    answer = tip(tmp_path_factory.mktemp("units"), scenario(units, ORDER))
    np.testing.assert_allclose(answer, reference, atol=1e-9 * np.abs(reference).max())


@few
@given(order=st.permutations(ORDER))
def test_another_order(reference: np.ndarray, tmp_path_factory: pytest.TempPathFactory, order: list[int]) -> None:
    answer = tip(tmp_path_factory.mktemp("order"), scenario(PLAIN, order))
    np.testing.assert_array_equal(answer, reference)


def test_mirrored(reference: np.ndarray, tmp_path: Path) -> None:
    """y → −y of the offset, the force, and the moment about z."""
    answer = tip(tmp_path, scenario(PLAIN, ORDER, mirror=-1.0))
    assert np.abs(reference[:, 1]).max() > 1e-5
    np.testing.assert_allclose(answer, reference * [1, -1, 1], atol=1e-12 * np.abs(reference).max())

"""The keys for root, loads, shapes and mounts: what they build, and what they refuse."""

from __future__ import annotations

import numpy as np
import pytest

import gbeam as gb
from gbeam.scenario import ScenarioError, build, loads

TEXT = """\
[beam]
length = "2 m"
section = { shape = "rectangle", width = "20 mm", thickness = "4 mm" }
material = { density = "2700 kg/m^3", youngs_modulus = "70 GPa" }
damping_ratio = 0.01
masses = [ { at = "2 m", mass = "0.1 kg", inertia = { x = 0.01, y = 0.02, z = 0.02 }, offset = ["10 mm", 0.0, 0.0] } ]
root = { rotation_y = "500 N m/rad", translation_z = "20 kN/m" }
[[beam.loads]]
at = "2 m"
force = { z = "5 N", x = { profile = "trapezoid", level = "-2 N", jerk = "4 N/s", start = "1 s", hold = "1 s" } }
follower = true
[[beam.loads]]
at = "1 m"
moment = { y = "3 N m" }
[[beam.loads]]
distributed = { y = "20 N/m" }
[model]
kind = "FOAM"
modes = { axial = 1, y = 2, z = 2 }
shapes = "adapted"
[motion.slew]
kind = "hub"
radius = "0.5 m"
rate = { profile = "constant", level = "60 rpm" }
pointing = "inward"
setting_angle = "30 deg"
gravity = [0.0, 0.0, "-1 g"]
[motion.free]
kind = "hub"
radius = "0.5 m"
inertia = "200 kg m^2"
torque = { profile = "sine", amplitude = "200 N m", duration = "10 s" }
stiffness = "50 N m/rad"
damping = "2 N m s/rad"
[response]
duration = "2 s"
"""


def test_what_they_build() -> None:
    case = build(loads(TEXT))
    beam = case.beam
    assert beam.root.springs == {"translation_z": 20e3, "rotation_y": 500.0}
    assert [load.follower for load in beam.loads] == [True, False, False]
    assert [load.at for load in beam.loads] == [2.0, 1.0, None]
    assert callable(beam.loads[0].force)
    np.testing.assert_allclose(beam.loads[0].force(1.7), [-2.0, 0.0, 5.0])
    np.testing.assert_allclose(beam.loads[1].moment(0.0), [0.0, 3.0, 0.0])  # type: ignore[operator, misc]
    np.testing.assert_allclose(beam.loads[2].distributed(0.0), [0.0, 20.0, 0.0])  # type: ignore[operator, misc]
    assert case.model.shapes == "adapted"
    slew, free = case.motions["slew"], case.motions["free"]
    assert isinstance(slew, gb.Hub) and isinstance(free, gb.Hub) and free.free and not slew.free
    np.testing.assert_allclose(slew.mount.gravity, [0, 0, -9.80665])
    np.testing.assert_allclose(slew.mount.R_HB[:, 0], [-1, 0, 0])
    np.testing.assert_allclose(slew.mount.R_HB[2], [0, 0.5, np.sqrt(0.75)])
    assert (float(free.stiffness), float(free.damping)) == (50.0, 2.0)


@pytest.mark.parametrize(
    ("old", "new", "place", "words"),
    [
        ('rotation_y = "500 N m/rad"', 'rotation_y = "500 N/m"', "beam.root.rotation_y", "rotational stiffness"),
        ('rotation_y = "500 N m/rad"', "rotation_w = 5", "beam.root.rotation_w", "unknown key"),
        ('z = "5 N"', 'z = "5 kg"', "beam.loads[0].force.z", "is a mass"),
        ('level = "-2 N"', 'level = "-2 m"', "beam.loads[0].force.x.level", "is a length"),
        ('profile = "trapezoid"', 'profile = "trapezium"', "beam.loads[0].force.x.profile", "trapezoid"),
        ('at = "1 m"', 'at = "3 m"', "beam.loads[1].at", "beyond the tip"),
        ('at = "1 m"\n', "", "beam.loads[1]", "at is missing"),
        ("distributed = {", 'at = "1 m"\ndistributed = {', "beam.loads[2].at", "beside distributed"),
        ('distributed = { y = "20 N/m" }', "distributed = {}", "beam.loads[2].distributed", "no component"),
        ('shapes = "adapted"', 'shapes = "adopted"', "model.shapes", "adapted"),
        ('pointing = "inward"', 'pointing = "inwards"', "motion.slew.pointing", "inward"),
        ('setting_angle = "30 deg"', 'stiffness = "5 N m/rad"', "motion.slew.stiffness", "beside rate"),
        ('gravity = [0.0, 0.0, "-1 g"]', "gravity = [0.0, 0.0]", "motion.slew.gravity", "three"),
        ("y = 2, z = 2", "y = 0, z = 2", "model.modes.y", "plane of the hub"),
    ],
)
def test_what_they_refuse(old: str, new: str, place: str, words: str) -> None:
    assert old in TEXT
    with pytest.raises(ScenarioError) as caught:
        build(loads(TEXT.replace(old, new)))
    told = [d for d in caught.value.diagnostics if d.path == place]
    assert told, caught.value
    assert words in str(told[0])


def test_a_section_at_a_right_angle_needs_shapes_along_z() -> None:
    only_z = TEXT.replace("y = 2, z = 2", "y = 0, z = 2").replace('"30 deg"', '"90 deg"')
    only_z = only_z[: only_z.index("[motion.free]")] + '[response]\nduration = "2 s"\n'
    assert build(loads(only_z)).model.counts == (1, 0, 2, 0, 0, 0)

"""Modes of systems and places at rest in three dimensions: what the viewer draws hangs together."""

from __future__ import annotations

import json

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import gbeam as gb
from gbeam.report import facts, report_of, report_of_file, variables_of, viewer_data

STRIP = gb.Beam(1.0, gb.Section.rectangle(0.04, 0.004), gb.Material(2700.0, 70e9), damping_ratio=0.01)
SIZE = 0.15  # of the length, of what a mode moves most


def mast() -> gb.System:
    """A strip that leans on a sprung foot, with a rod on a hinge at its tip: it bends by its weight, and turns."""
    foot = gb.RigidBody(0.5, (1e-3,) * 3, points={"top": gb.Place((0.05, 0, 0.1), (0, -0.4, 0.3))})
    rod = gb.RigidBody(0.02, (1e-5, 1e-4, 1e-4), centre=(0.1, 0, 0), points={"end": (0.2, 0, 0)})
    stiffness = {"angle_1": 20.0, "angle_2": 20.0}
    joints = {
        "sprung": gb.Joint("universal", "foot", axes=[(0, 1, 0), (0, 0, 1)], stiffness=stiffness),
        "clamp": gb.Joint("fixed", "strip", on="foot.top"),
        "hinge": gb.Joint("revolute", "rod", on="strip.tip", axes=[(0, 1, 0)], stiffness=0.05),
    }
    strip = gb.assemble(STRIP, "exact", axial=0, y=1, z=2)
    return gb.System({"foot": foot, "strip": strip, "rod": rod}, joints, gravity=(0, 0, -3.0))


def test_points_beams_and_turns_of_a_mode_belong_together() -> None:
    """To first order a point moves as its body's root does, by its turning, and as its beam bends."""
    modes = gb.modes(mast(), errors=False)
    at = modes.points.index
    foot, root, tip, end, hinge = (at(name) for name in ("foot.root", "strip.root", "strip.tip", "rod.end", "rod.root"))
    arms = modes.place[[root, end]] - modes.place[[foot, hinge]]
    for moved, from_, arm in zip((root, end), (foot, hinge), arms, strict=True):
        carried = modes.point_shape[:, from_] + np.cross(modes.point_turn[:, from_], arm)
        np.testing.assert_allclose(modes.point_shape[:, moved], carried, atol=1e-12)
    np.testing.assert_allclose(modes.point_turn[:, root], modes.point_turn[:, foot], atol=1e-12)
    beam, axes = modes.bodies["strip"], Rotation.from_quat(np.roll(modes.attitude[root], -1)).as_matrix()
    bent = modes.place[tip] - modes.place[root]
    np.testing.assert_allclose(bent, axes @ ([1, 0, 0] + beam.outline.displacement[0, -1]), atol=1e-9)
    swung = modes.point_shape[:, root] + np.cross(modes.point_turn[:, root], bent) + beam.outline_shape[:, -1] @ axes.T
    np.testing.assert_allclose(modes.point_shape[:, tip], swung, atol=1e-9)
    assert np.abs(modes.point_turn[:, at("rod.root")] - modes.point_turn[:, tip]).max() > 0.1  # the hinge turns


def test_a_mode_is_drawn_as_a_motion_of_a_period() -> None:
    modes = gb.modes(mast(), errors=False)
    header, numbers = viewer_data(modes)
    assert header["modes"]["labels"][0].startswith(f"1: {modes.frequency[0]:.4g} Hz, ")
    array = numbers.array
    for motion in header["modes"]["motions"]:
        assert motion["relative"] and motion["period"] == 2.0
        foot, strip, rod = motion["parts"]
        frames = [_read(array, each["frame"]) for each in (foot, strip, rod)]
        np.testing.assert_allclose([each[0] for each in frames], [each[-1] for each in frames], atol=1e-6)
        assert foot["box"] and foot["joint"] and rod["joint"] and "joint" not in strip
        bent = _read(array, strip["beam"]["displacement"])
        # What moves most moves by a share of the system's size, unless it turns too far.
        most = max(np.abs(bent - bent.mean(axis=0)).max(), *(np.ptp(each[:, :3], axis=0).max() / 2 for each in frames))
        assert 0.01 < most < SIZE * 2 * motion["radiusShown"]
        # The rod hangs on the tip as it swings: to the second order of what is drawn.
        root = frames[1]
        tip = root[:, :3] + Rotation.from_quat(np.roll(root[:, 3:7], -1, axis=1)).apply(bent[:, -1] + [1, 0, 0])
        assert np.abs(tip - frames[2][:, :3]).max() < 0.1


def _read(array: np.ndarray, ref: dict[str, object]) -> np.ndarray:
    shape: list[int] = ref["shape"]  # type: ignore[assignment]
    first: int = ref["at"]  # type: ignore[assignment]
    return np.asarray(array[first : first + int(np.prod(shape))]).reshape(shape).astype(float)


@pytest.mark.parametrize("question", [gb.modes, gb.static])
def test_a_page_and_a_file_show_what_a_notebook_shows(question: object, tmp_path: object) -> None:
    result = question(mast())  # type: ignore[operator]
    page = report_of(result)
    header = json.loads(page.split('id="gbeam-header">')[1].split("</script>")[0])
    assert '<div id="gbeam-viewer">' in page
    key = "modes" if question is gb.modes else "scene"
    assert (
        json.loads(json.dumps(viewer_data(result)[0][key]))["motions"][0]["parts"]
        and header[key]["motions"][0]["parts"]
    )
    result.save(tmp_path / "result.nc")  # type: ignore[operator]
    assert report_of_file(tmp_path) == page  # type: ignore[arg-type]
    if question is gb.static:
        (motion,) = header["scene"]["motions"]
        assert motion["time"]["shape"] == [1] and motion["largest"] > 0.01
        assert {part["frame"]["shape"][0] for part in motion["parts"]} == {1}
        assert facts(result)["motions"]["ground"]["points"] and "motions/ground/hangs_on" in variables_of(result)


def test_a_page_of_flexible_bodies_alone_shows_one_by_matrices(tmp_path: object) -> None:
    """A mass on springs carries a strip: no body has a box."""
    nodes, moved = [[0.0, 0.0, 0.0], [0.3, 0.0, 0.0]], np.eye(6)
    moved[1, 5], moved[2, 4] = 0.3, -0.3  # of the second node by the first
    stretch, mass = np.hstack([-moved, np.eye(6)]), np.diag([1.0, 1.0, 1.0, 0.01, 0.01, 0.01])
    stiffness = stretch.T @ np.diag([2e3, 3e3, 4e3, 50.0, 60.0, 70.0]) @ stretch
    model = gb.ImportedModel(np.kron(np.eye(2), mass), stiffness, nodes)
    block = model.reduced(modes=3, damping_ratio=0.01, clamp=[0], points={"end": 1}, interfaces=["end"])
    joints = {"root": gb.Joint("fixed", "block"), "clamp": gb.Joint("fixed", "strip", "block.end")}
    bodies = {"block": block, "strip": gb.assemble(STRIP, "exact", axial=0, y=1, z=2)}
    response = gb.simulate(gb.System(bodies, joints, gravity=(0, 0, -3.0)), duration=0.1, step=1e-3, estimate=False)
    assert "strip" in report_of(response)

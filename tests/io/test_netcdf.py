"""A study written, and read again with xarray and with h5py, is the same."""

from __future__ import annotations

import csv
import io
import operator
import os
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest
import xarray as xr
from scipy.integrate import cumulative_trapezoid

import gbeam as gb
from gbeam.io import Group, Variable, csv_of, image, read_stored, stored
from gbeam.results import (
    Accounting,
    AxesResult,
    Base,
    Failure,
    Fatigue,
    HubResult,
    LimitUse,
    LoadPeak,
    Loads,
    NotFollowed,
    PeakPair,
    Peaks,
    Provenance,
    RootHistory,
    RootLoads,
    Shortfall,
    Sizes,
    StressCycles,
)
from gbeam.results import StationStatistics as Statistics

from ..files import opened
from ..responses import of_beam, with_body
from ..specimens import hub_beam

T, N = 11, 4
RANDOM = np.random.default_rng(0)
TIME = np.linspace(0, 1, T)
SCENARIO = "title = 'ω'\n" + "# long\n" * 20_000  # more than an attribute of HDF5 holds


QUANTITIES = {"rate": "rad/s", "acceleration": "rad/s^2", "jerk": "rad/s^3"}
LIMITS = (
    *(
        LimitUse(f"axis {i}", name, unit, 10.0 * i + k, np.inf if i == 3 else 20.0, 0.1 * i)
        for i in (1, 2, 3)
        for k, (name, unit) in enumerate(QUANTITIES.items())
    ),
    LimitUse("arm", "power", "W", 4e4, 5e4, 0.7),
)
SHORTFALLS = (
    Shortfall(0.55, 1.0, "below idle", 0.8, 0.7, 1.4, "g", 'idle = "0.70 g" would follow it'),
    Shortfall(
        0.3, 0.4, "too sharp for the arm", 0.35, 302.0, 128.0, "m/s^4", 'smoothing = "142 ms" or more is trackable'
    ),
)

FATIGUE = Fatigue(
    3.0,
    StressCycles(np.array([3.0, 2.0]), np.zeros(2), np.array([1.0, 0.5])),
    StressCycles(np.array([4.0, 3.0, 3.0]), np.ones(3), np.ones(3)),
)
PAIRS = {
    "largest_load": PeakPair(80.0, 90.0, 0.2, 0.3, "", "the root"),
    "tip": PeakPair(2.0, 2.1, 0.3, 0.4),
    "stress": PeakPair(),
}
ACCOUNTING = Accounting(
    0.05, 4.0, 14.0, (0.0, 1.0), 0.5,
    (LoadPeak(0.2, 80.0, 0.2, 79.0, 0.02, (0.01, -0.02), (0.0, 0.0), instant_error=0.03),
     LoadPeak(0.7, 60.0, 0.7, 30.0, 0.5, (0.01, -0.02), (0.0, 0.0), "corner", 0.6)),
    (NotFollowed(0.5, 1.0, "corner", 60.0),),
)  # fmt: skip


def _random(*shape: int) -> np.ndarray:
    return RANDOM.standard_normal(shape)


def _response(name: str, environment: str) -> gb.Response:
    return of_beam(
        name,
        environment,
        TIME,
        Base(_random(T, 3), _random(T, 3), _random(T, 3)),
        _random,
        size=N,
        warnings=("one", "two"),
        stations=np.array([0.1, 0.3]),
        displacement=_random(T, 2, 3),
        peaks=Peaks(_random(3), _random(3), np.full(3, np.nan)),
        integrator="newmark",
        residual_from=float("nan"),
    )


@pytest.fixture(scope="module")
def study() -> gb.Study:
    """All three environments, with a comparison."""
    held = TIME > 0.5
    axes = AxesResult(*(_random(T, 3) for _ in range(5)), held, ((0.55, 1.0, "below idle"),), LIMITS, SHORTFALLS, 0.15)
    hub = HubResult(_random(T), _random(T), _random(T))
    loads = Loads(
        np.array([0.0, 0.3]), *(_random(T, 2, 3) for _ in range(4)), *_random(2, T, 2), _random(T, 2, 3), *_random(2, T)
    )
    responses = {
        "flight": _response("flight", "flight"),
        "spin": replace(_response("spin", "centrifuge"), axes=axes),
        "slew": replace(with_body(_response("slew", "hub"), model="exact", loads=loads), hub=hub),
    }
    sizes = (Sizes(*(abs(_random(2, 3)) for _ in range(3))) for _ in range(3))
    split = Statistics(np.array([0.1, 0.3]), 18.0, *sizes, *(_random(T, 3) for _ in range(4)))
    history = RootHistory(*(_random(T, 3) for _ in range(4)))
    root = RootLoads(*(abs(_random(3)) for _ in range(6)), 1.0, 2.0, 3.0, history)
    comparison = gb.Comparison(
        "flight", "spin", TIME, _random(T, 3), ~held, *(abs(_random(3)) for _ in range(4)), PAIRS, ACCOUNTING,
        {"tip": 0.02}, stations=split, root=root, fatigue=FATIGUE,
    )  # fmt: skip
    return gb.Study("a title", responses, (comparison,))


@pytest.fixture(scope="module")
def file(study: gb.Study, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The study, written."""
    path = tmp_path_factory.mktemp("store") / "result.nc"
    origin = Provenance(SCENARIO, ("a=1", "b=2"), command="gbeam run s.toml")
    replace(study, provenance=origin).save(path)
    return path


@pytest.fixture(scope="module")
def tree(file: Path) -> xr.DataTree:
    """The file, read."""
    return opened(file)


def test_xarray_reads_what_was_written(study: gb.Study, tree: xr.DataTree) -> None:
    flight, spin = (tree[f"motions/{name}"] for name in ("flight", "spin"))
    along_y = flight["beam_displacement"].sel(axis="y")
    np.testing.assert_array_equal(along_y, study.responses["flight"].displacement[:, :, 1])
    assert list(spin["not_followed_reason"].values) == ["below idle"]
    assert "hub_angle" not in flight and "not_followed_reason" not in flight
    np.testing.assert_array_equal(tree["comparisons/spin/difference"], study.comparisons[0].difference)
    assert flight.attrs["warnings"] == "one\ntwo"
    assert "error_estimate" not in flight.attrs  # none was made
    compared = tree["comparisons/spin"]
    assert compared.attrs["verdict"] == study.comparisons[0].verdict == tree.attrs["verdict"]
    assert compared.attrs["accepted"] == "false" and "Study 'a title': NOT ACCEPTED" in tree.attrs["summary"]
    assert list(compared["criterion_name"].values) == ["tip"] and float(compared["criterion_most_allowed"][0]) == 0.02
    assert float(compared["criterion_value"][0]) == pytest.approx(0.05)
    assert [float(compared[f"largest_load_{each}"]) for each in ("flight", "machine")] == [80.0, 90.0]
    assert compared["largest_load_place_machine"].item() == "the root"
    np.testing.assert_array_equal(compared["load_peak_instant_error"], [0.03, 0.6])
    assert [float(compared[name]) for name in ("tip_flight", "tip_machine", "tip_time_machine")] == [2.0, 2.1, 0.4]
    assert "stress_flight" not in compared  # not known
    assert float(compared["followed_share"]) == 0.5
    np.testing.assert_array_equal(compared["load_peak_flight"], [80.0, 60.0])
    assert list(compared["load_peak_reason"].values) == ["", "corner"]
    assert float(compared["not_followed_to"][0]) == 1.0


BASE = {"root_acceleration": "a_WO_B", "angular_velocity": "w_WB_B", "angular_acceleration": "alpha_WB_B"}
OF_WHOLE = ("place", "velocity", "acceleration", "attitude", "angular_velocity", "q", "effort", "ground_force")
RESPONSE = {
    "beam_displacement": "body.displacement",
    **{f"beam_{name}": f"body.base.{field}" for name, field in BASE.items()},
    "beam_tip_max_abs": "body.peaks.max_abs",
    "beam_tip_time_of_max": "body.peaks.time_of_max",
    **{name: name for name in OF_WHOLE},
    "rates": "qd",
    **{f"ground_{name}": f"base.{field}" for name, field in BASE.items()},
}
OF_HUB = {f"hub_{name}": f"hub.{name}" for name in ("angle", "rate", "acceleration")}
OF_LOADS = {
    f"beam_{name}": f"body.loads.{name}"
    for name in (
        *("section_force", "section_moment", "stress", "stress_tension", "stress_compression"),
        *("beam_torque", "drive_torque"),
    )
}
OF_AXES = {
    **{f"axis_{name}": f"axes.{name}" for name in ("angle", "rate", "acceleration")},
    **{f"load_{name}": f"axes.{name}" for name in ("reference", "actual")},
}


@pytest.mark.parametrize(
    ("name", "fields"), [("spin", RESPONSE | OF_AXES), ("slew", RESPONSE | OF_HUB | OF_LOADS)], ids=["spin", "slew"]
)
def test_every_variable_holds_what_its_name_says(
    study: gb.Study, tree: xr.DataTree, name: str, fields: dict[str, str]
) -> None:
    """All histories of the study are random: none can stand for another."""
    for variable, field in fields.items():
        value = operator.attrgetter(field)(study.responses[name])
        np.testing.assert_array_equal(tree[f"motions/{name}"][variable], value, err_msg=variable)


def test_what_is_called_a_rate_is_one(tmp_path: Path) -> None:
    """In the file of a slew: rates integrate to what they are the rates of, by the trapezium rule."""
    slew = gb.Hub(radius=0.5, rate=gb.SmoothStep(2.0, 1.5))
    path = tmp_path / "slew.nc"
    gb.simulate(hub_beam("FOAM", 0, 2), slew, duration=2.0, step=2e-3).save(path)
    file = opened(path)
    (answer,) = [node.to_dataset() for node in file.subtree if "hub_rate" in node]
    time = answer["time"].values
    for rate, whole in (
        ("hub_rate", "hub_angle"),
        ("hub_acceleration", "hub_rate"),
        ("beam_angular_acceleration", "beam_angular_velocity"),
        ("ground_angular_acceleration", "ground_angular_velocity"),
        ("rates", "q"),
    ):
        values, wanted = answer[rate].values, answer[whole].values
        sums = cumulative_trapezoid(values, time, axis=0, initial=0.0)
        size = np.abs(wanted).max()
        assert size > 0
        np.testing.assert_allclose(sums, wanted - wanted[0], atol=1e-3 * size, err_msg=rate)


def test_histories_of_a_run_are_written_once() -> None:
    """Motions of roots are those of points, too: they are asked for by the body."""
    strip = gb.Section.rectangle(width=0.02, thickness=0.004)
    arm = gb.assemble(
        gb.Beam(0.3, strip, gb.Material(2700, 70e9), damping_ratio=0.01), "FOAM", axial=1, y=2, z=2, stations=[0.1, 0.3]
    )
    hub = gb.RigidBody(1.0, (0.1, 0.2, 0.3), points={"rim": (0.1, 0.02, 0)})
    joints = {
        "hinge": gb.Joint("revolute", "hub", axes=[(0.1, 1, 0.3)], initial=0.2),
        "clamp": gb.Joint("fixed", "arm", on="hub.rim"),
    }
    swung = gb.System({"hub": hub, "arm": arm}, joints, gravity=(0.3, 0.2, -9.81))
    variables = stored(gb.simulate(swung, duration=0.2, step=1e-3, estimate=False)).variables
    histories = {name: each for name, each in variables.items() if np.shape(each)[:1] == (201,)}
    moving = {
        name: {column.tobytes() for column in each.reshape(201, -1).T if np.ptp(column)}
        for name, each in histories.items()
        if "stress" not in name  # which may be the same on both sides
    }
    del moving["arm_outline_time"], moving["arm_outline"]  # pictures at times of their own
    twice = {
        name for name in moving for other in moving.keys() - {name} if moving[name] and moving[name] <= moving[other]
    }
    assert twice == {"arm_root_acceleration", "arm_angular_velocity"}
    assert {"q", "rates", "arm_station_acceleration"} <= moving.keys()


def test_zeros_take_no_room() -> None:
    many = 100_000
    random = np.random.default_rng(0).normal(size=many)
    columns = {"still": np.zeros(many), "moved": random}
    written = image({"": Group({name: Variable(("time",), values, {}) for name, values in columns.items()})})
    assert 8 * many < len(written) < 8.2 * many
    with h5py.File(io.BytesIO(written)) as file:
        assert not np.any(file["still"][:])
        np.testing.assert_array_equal(file["moved"][:], random)


def test_histories_at_the_root_of_a_comparison(study: gb.Study, tree: xr.DataTree) -> None:
    compared = tree["comparisons/spin"]
    assert study.comparisons[0].root is not None
    history = study.comparisons[0].root.history
    names = {"force_flight": "force_history_flight", "moment_flight": "moment_history_flight"}
    for name in ("force_flight", "force_centrifuge", "moment_flight", "moment_centrifuge"):
        variable = compared[f"root_{names.get(name, name)}"]  # the largest values have the others' names
        np.testing.assert_array_equal(variable, getattr(history, name))
        assert variable.attrs["frame"].startswith("S: ")


def test_stress_cycles(tree: xr.DataTree) -> None:
    spin = tree["comparisons/spin"]
    np.testing.assert_array_equal(spin["stress_range_machine"], FATIGUE.machine.range)
    np.testing.assert_array_equal(spin["stress_count_flight"], FATIGUE.flight.count)
    assert float(spin["damage_ratio"]) == pytest.approx((4**3 + 2 * 3**3) / (3**3 + 0.5 * 2**3))


def test_the_torque_of_a_drive_is_the_hubs(study: gb.Study) -> None:
    """It is given on a free hub; what follows from the loads where the rate is prescribed is the body's, too."""
    slew = study.responses["slew"]
    torque = _random(T)
    free = replace(slew, hub=replace(slew.hub, drive_torque=torque)).to_xarray()
    np.testing.assert_array_equal(free["drive_torque"], torque)
    np.testing.assert_array_equal(free["beam_drive_torque"], slew.loads.drive_torque)
    assert "drive_torque" not in slew.to_xarray()


def test_what_is_written_is_what_xarray_gets(study: gb.Study, tree: xr.DataTree, tmp_path: Path) -> None:
    built = study.to_xarray()
    assert [node.path for node in built.subtree] == [node.path for node in tree.subtree]
    for node in built.subtree:
        if node.path != "/":  # which says when it was made and from what
            xr.testing.assert_identical(node.to_dataset(), tree[node.path].to_dataset())
    study.responses["spin"].save(tmp_path / "spin.nc")
    # The file also has its figures as JSON, for a report.
    read = xr.load_dataset(tmp_path / "spin.nc", engine="h5netcdf").drop_vars("facts")
    xr.testing.assert_identical(read, study.responses["spin"].to_xarray())


def test_a_failure_is_kept(study: gb.Study, tmp_path: Path) -> None:
    failed = replace(study, failures={f"motion{i}": Failure("diverged", f"reason {i}") for i in range(12)})
    failed.save(tmp_path / "x.nc")
    assert opened(tmp_path / "x.nc").attrs["failure_motion11"] == "diverged: reason 11"


def test_limits_and_what_cannot_be_followed(study: gb.Study, file: Path, tree: xr.DataTree) -> None:
    spin = tree["motions/spin"]
    np.testing.assert_array_equal(spin["acceleration_used"], [11, 21, 31])
    np.testing.assert_array_equal(spin["acceleration_allowed"], [20, 20, np.inf])
    np.testing.assert_array_equal(spin["jerk_time"].sel(machine_axis=[3, 1]), [0.1 * 3, 0.1])
    assert spin["jerk_used"].attrs["units"] == "rad s-3"
    assert (float(spin["power_used"]), float(spin["power_allowed"]), float(spin["power_time"])) == (4e4, 5e4, 0.7)
    assert float(spin["control_point"]) == 0.15
    assert list(spin["shortfall_reason"].values) == ["below idle", "too sharp for the arm"]
    assert list(spin["shortfall_unit"].values) == ["g", "m/s^4"] and list(spin["shortfall_reference"].values) == [
        0.7,
        302,
    ]
    assert str(spin["shortfall_remedy"].values[1]).startswith("smoothing")
    sizes = tree["comparisons/spin/station_rms_difference"]
    assert study.comparisons[0].stations is not None
    np.testing.assert_array_equal(sizes, study.comparisons[0].stations.difference.rms)
    with h5py.File(file) as opened:
        group = opened["motions/spin"]
        np.testing.assert_array_equal(group["rate_used"][:], [10, 20, 30])
        assert [each.decode() for each in group["shortfall_unit"]] == ["g", "m/s^4"]
        assert [each.decode() for each in group["not_followed_reason"]] == ["below idle"]
        np.testing.assert_array_equal(group["not_followed_to"][:], [1.0])
        plain = {str, np.float64, np.int64, np.ndarray, bytes, np.bytes_}
        skipped = {"DIMENSION_LIST", "REFERENCE_LIST", "CLASS", "NAME", "_Netcdf4Dimid", "_Netcdf4Coordinates"}
        for variable in group.values():
            for name, value in variable.attrs.items():
                assert name in skipped or type(value) in plain, (variable.name, name, type(value))
            assert variable.dtype.kind in "fiOS" and variable.dtype != bool


def test_provenance(tree: xr.DataTree) -> None:
    assert str(tree["scenario"].values) == SCENARIO
    assert tree.attrs["title"] == "a title" and tree.attrs["outcome"] == "done"
    assert tree.attrs["overrides"] == "a=1\nb=2" and tree.attrs["command"] == "gbeam run s.toml"
    assert tree.attrs["date"].endswith("+00:00")
    assert tree.attrs["gbeam_version"] and "jax " in tree.attrs["dependencies"] and tree.attrs["platform"]


def test_every_number_says_what_it_is(tree: xr.DataTree) -> None:
    for group in tree["motions"].children.values():
        for name, variable in group.variables.items():
            if variable.dtype.kind == "f":
                assert variable.attrs["units"] and variable.attrs["long_name"], name
            if "axis" in variable.dims and name != "axis":
                frame = "S: axes of the deformed section" if name.startswith("beam_section_") else "B: base axes"
                stated = {"acceleration": "axes of the point", "angular_velocity": "axes of the point"}
                stated |= dict.fromkeys(("place", "velocity", "ground_force", "ground_moment"), "ground")
                assert variable.attrs["frame"].startswith(stated.get(name, frame)), name


def test_h5py_reads_it(study: gb.Study, file: Path) -> None:
    with h5py.File(file) as opened:
        group = opened["motions/spin"]
        np.testing.assert_array_equal(group["beam_displacement"][:], study.responses["spin"].displacement)
        assert [each.decode() for each in group["axis"]] == ["x", "y", "z"]
        np.testing.assert_array_equal(group["not_followed"][:], study.responses["spin"].axes.not_followed)
        # Attributes that MATLAB reads: text and numbers, nothing else.
        kinds = {type(value) for node in (opened, group) for value in node.attrs.values()}
        assert kinds <= {str, np.float64, np.int64, np.ndarray, bytes, np.bytes_}
        assert group.attrs["environment"] == "centrifuge"


def test_a_group_opens_alone(file: Path) -> None:
    with xr.open_dataset(file, group="motions/flight", engine="h5netcdf") as flight:
        whole = {"time": T, "point": 2, "axis": 3, "euler": 4, "coordinate": N}
        assert dict(flight.sizes) == whole | {"beam_station": 2}


def test_a_file_is_replaced_whole_or_not_at_all(
    study: gb.Study, file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / file.name
    path.write_bytes(file.read_bytes())
    before = path.read_bytes()

    def fail(*_: object, **__: object) -> None:
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patched:
        patched.setattr(h5py.Group, "create_dataset", fail)
        with pytest.raises(OSError, match="No space"):
            study.save(path)
    assert path.read_bytes() == before
    assert os.listdir(path.parent) == [path.name]
    replace(study, title="another").save(path)
    assert opened(path).attrs["title"] == "another"


@pytest.mark.parametrize("content", [None, b"not netCDF"])
def test_what_is_no_result_is_refused(content: bytes | None, tmp_path: Path) -> None:
    path = tmp_path / "x.nc"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(gb.InputError, match=r"x\.nc is (no file|not a netCDF-4 file)"):
        read_stored(path)


def test_histories_as_text_are_those_of_the_file(study: gb.Study, tmp_path: Path) -> None:
    study.save(tmp_path / "x.nc")
    rows = list(csv.DictReader(csv_of(read_stored(tmp_path / "x.nc")).splitlines()))
    assert len(rows) == sum(len(response.time) for response in study.responses.values())
    for name, response in study.responses.items():
        lines = [row for row in rows if row["motion"] == name]
        np.testing.assert_allclose([float(row["time_s"]) for row in lines], response.time, rtol=1e-8)
        tip = [[float(row[f"tip_{axis}_m"]) for axis in "xyz"] for row in lines]
        np.testing.assert_allclose(tip, response.tip, rtol=1e-8, atol=1e-300)
        if response.axes is None:
            assert lines[0]["axis_rate_1_rad_per_s"] == ""
        else:
            rates = [float(row["axis_rate_2_rad_per_s"]) for row in lines]
            np.testing.assert_allclose(rates, response.axes.rate[:, 1], rtol=1e-8)
        if response.loads is not None:
            carried = [[float(row[f"root_section_force_{axis}_N"]) for axis in "xyz"] for row in lines]
            np.testing.assert_allclose(carried, response.loads.section_force[:, 0], rtol=1e-8, atol=1e-300)
            assert float(lines[-1]["stress_Pa"]) == pytest.approx(response.loads.stress[-1, 0])


def test_histories_as_text_name_bodies_where_there_are_several(study: gb.Study, tmp_path: Path) -> None:
    slew = study.responses["slew"]
    bodies = {name: with_body(slew, displacement=_random(T, 2, 3)).body for name in ("left", "right")}
    bodies["right"] = replace(bodies["right"], loads=None)
    gb.Study("", {"slew": replace(slew, bodies=bodies)}, ()).save(tmp_path / "x.nc")
    rows = list(csv.DictReader(csv_of(read_stored(tmp_path / "x.nc")).splitlines()))
    for name, body in bodies.items():
        tip = [[float(row[f"{name}_tip_{axis}_m"]) for axis in "xyz"] for row in rows]
        np.testing.assert_allclose(tip, body.tip, rtol=1e-8, atol=1e-300)
    assert float(rows[3]["left_stress_Pa"]) == pytest.approx(slew.loads.stress[3, 0])
    assert rows[3]["right_stress_Pa"] == rows[3]["right_root_section_force_x_N"] == ""
    assert "tip_x_m" not in rows[0]

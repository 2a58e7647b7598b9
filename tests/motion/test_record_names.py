"""The names of columns: units, other kinds of quantity, load factors and mirrored axes, each on the F-16 record."""

from __future__ import annotations

from itertools import product
from pathlib import Path

import pytest

from gbeam import InputError
from gbeam.motion import Conditioning, FlightRecord, Rates, read_flight, unit_in_name

F16 = Path(__file__).parents[2] / "examples" / "data" / "f16_8g_turn.csv"
RIGHT = {"x": "n_x_g", "y": "-n_y_g", "z": "-n_z_g"}


def fly(path: Path = F16, unit: str = "g", quantity: str = "specific-force", **columns: str) -> FlightRecord:
    names = RIGHT | columns
    return read_flight(path, "time_s", *names.values(), unit, quantity=quantity)  # type: ignore[arg-type]


def renamed(folder: Path, **names: str) -> Path:
    header, rows = F16.read_text().split("\n", 1)
    path = folder / "renamed.csv"
    path.write_text("\n".join([",".join(names.get(name, name) for name in header.split(",")), rows]))
    return path


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("n_x_g", "g"),
        ("az_g", "g"),
        ("acc_z_mps2", "mps2"),
        ("accZ [m/s^2]", ""),  # whose bracket is read elsewhere
        ("body.az_m_s2", "m/s2"),
        ("p_rad_s", "rad/s"),
        ("gyro_x_dps", "dps"),
        ("time_ms", "ms"),
        ("TimeUS", "us"),
        ("accelerometer_m_s2[1]", "m/s2"),
        ("acc_g(:,3)", "g"),
        ("acc_highG", ""),
        ("acc_high_g", ""),
        ("az_mV", "mv"),
        ("acc_1", ""),
        ("az", ""),
        ("g", ""),
        ("", ""),
    ],
)
def test_a_name_may_end_in_a_unit(name: str, unit: str) -> None:
    assert unit_in_name(name) == unit


@pytest.mark.parametrize(
    ("columns", "where", "words"),
    [
        ({"x": "p_rad_s"}, "record.x", "names 'p_rad_s', by its name a rate of rotation and no load; name a column of"),
        ({"y": "-roll_deg"}, "record.y", "names 'roll_deg', by its name an angle and no load"),
        ({"z": "mach"}, "record.z", "by its name a speed and no load"),
        ({"z": "-altitude_m"}, "record.z", "by its name a height and no load"),
        ({"x": "time_s"}, "record.x", "by its name a time and no load"),
        ({"y": "-n_z_g"}, "record.z", "names 'n_z_g', which is y too"),
    ],
)
def test_what_is_no_load_by_its_name_is_refused(columns: dict[str, str], where: str, words: str) -> None:
    with pytest.raises(InputError) as caught:
        fly(**columns)
    assert caught.value.where == where and words in str(caught.value)
    assert 'skip_checks = ["columns"]' in caught.value.fix


def test_a_misleading_name_is_taken_where_it_is_trusted(tmp_path: Path) -> None:
    path = renamed(tmp_path, n_x_g="alpha")
    with pytest.raises(InputError, match="by its name an angle"):
        fly(path, x="alpha")
    trusting = Conditioning(skip_checks=("columns",))
    kept = read_flight(path, "time_s", "alpha", "-n_y_g", "-n_z_g", "g", conditioning=trusting)
    assert (kept.acceleration.values == fly().acceleration.values).all()


@pytest.mark.parametrize(
    ("name", "unit", "right"), [("az_g", "m/s^2", "g"), ("acc_z_mps2", "g", "m/s^2"), ("az_m_s2", "g", "m/s^2")]
)
def test_a_units_name_is_the_scenarios(tmp_path: Path, name: str, unit: str, right: str) -> None:
    path = renamed(tmp_path, n_x_g="nx", n_y_g="ny", n_z_g=name)
    with pytest.raises(InputError, match=f"record.unit is .* and the file gives column '{name}' in .*") as caught:
        fly(path, unit, x="nx", y="-ny", z=f"-{name}")
    assert f'write unit = "{right}"' in caught.value.fix


def test_a_unit_of_another_quantity_is_refused(tmp_path: Path) -> None:
    path = renamed(tmp_path, n_z_g="az [rad/s]")
    with pytest.raises(InputError, match=r"record.unit is g, and the file gives column 'az' in rad/s, of rate"):
        fly(path, z="-az")


@pytest.mark.parametrize(
    ("columns", "mirrored"),
    [
        ({}, False),
        ({"x": "-n_z_g", "z": "n_x_g"}, True),  # x and z exchanged
        ({"x": "-n_y_g", "y": "n_x_g"}, True),
        ({"y": "n_y_g"}, True),
        ({"x": "-n_z_g", "z": "-n_x_g"}, False),  # a specimen that stands upright
        ({"x": "n_y_g", "y": "n_x_g"}, False),  # turned by a right angle
        ({"x": "0"}, False),
    ],
)
def test_a_mirrored_mapping_is_said(columns: dict[str, str], mirrored: bool) -> None:
    options = {"quantity": "acceleration"} if columns.get("z") == "-n_x_g" else {}
    notes = fly(**columns, **options).summary.notes
    assert any("(determinant -1)" in note for note in notes) is mirrored


TURNED = {
    "aircraft axes": (("n_x_g", "-n_y_g", "-n_z_g"), ("p_rad_s", "-q_rad_s", "-r_rad_s")),
    "upright": (("-n_z_g", "-n_y_g", "-n_x_g"), ("-r_rad_s", "-q_rad_s", "-p_rad_s")),
    "across": (("n_y_g", "n_x_g", "-n_z_g"), ("q_rad_s", "p_rad_s", "-r_rad_s")),
}


@pytest.mark.parametrize("name", TURNED)
def test_body_rates_follow_the_axes_of_the_loads(name: str) -> None:
    """A rotation R takes components of both: of loads and of rates, which all other signs and orders are not."""
    loads, right = TURNED[name]
    options = {"quantity": "acceleration"}
    read_flight(F16, "time_s", *loads, "g", rates=Rates(*right, "rad/s"), **options)  # type: ignore[arg-type]
    plain = [each.lstrip("-") for each in right]
    for signs in product(("", "-"), repeat=3):
        turns = [sign + each for sign, each in zip(signs, plain, strict=True)]
        if turns == [*right]:
            continue
        with pytest.raises(
            InputError, match=r"record\.[pqr] is '.*' beside [xyz] = '.*': p, q and r are about other"
        ) as caught:
            read_flight(F16, "time_s", *loads, "g", rates=Rates(*turns, "rad/s"), **options)  # type: ignore[arg-type]
        assert f'write p = "{right[0]}", q = "{right[1]}", r = "{right[2]}"; ' in caught.value.fix
    trusting = Conditioning(skip_checks=("columns",))
    rates = Rates(*plain, "rad/s")
    read_flight(F16, "time_s", *loads, "g", rates=rates, conditioning=trusting, **options)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("loads", "turns", "words"),
    [
        (("0", "0", "-n_z_g"), ("p_rad_s", "-q_rad_s", "r_rad_s"), r"record.r is 'r_rad_s' beside z = '-n_z_g'"),
        (("0", "0", "-n_z_g"), ("0", "0", "-r_rad_s"), ""),
        (("n_x_g", "-n_y_g", "n_z_g"), ("p_rad_s", "-q_rad_s", "-r_rad_s"), ""),  # a load factor upwards
        (("n_x_g", "-n_y_g", "n_z_g"), ("p_rad_s", "-q_rad_s", "r_rad_s"), r"record.p mirrors .*\(determinant -1\)"),
        (("n_x_g", "-n_y_g", "-n_z_g"), ("roll_deg", "-q_rad_s", "-r_rad_s"), r"names 'roll_deg', by its name an angl"),
        (("n_x_g", "-n_y_g", "-n_z_g"), ("p_rad_s", "-p_rad_s", "-r_rad_s"), r"names 'p_rad_s', which is p too"),
    ],
)
def test_one_axis_alone_and_mirrored_loads(loads: tuple[str, ...], turns: tuple[str, ...], words: str) -> None:
    def flown() -> FlightRecord:
        return read_flight(F16, "time_s", *loads, "g", rates=Rates(*turns, "rad/s"), quantity="acceleration")  # type: ignore[misc]

    if not words:
        assert flown().rates is not None
        return
    with pytest.raises(InputError, match=words):
        flown()


def test_the_components_of_one_array_are_its_axes(tmp_path: Path) -> None:
    """PX4 names accelerometer_m_s2[0] to [2] beside gyro_rad[0] to [2]."""
    names = {f"{one}_{axis}{end}": f"{two}[{k}]" for one, axes, end, two in (("n", "xyz", "_g", "acc"),
             ("", "pqr", "_rad_s", "gyro_rad")) for k, axis in enumerate(axes)}  # fmt: skip
    path = renamed(tmp_path, **{key.lstrip("_"): each for key, each in names.items()})
    loads = ("time_s", "acc[0]", "-acc[1]", "-acc[2]", "g")
    assert read_flight(path, *loads, rates=Rates("gyro_rad[0]", "-gyro_rad[1]", "-gyro_rad[2]", "rad/s")).rates
    with pytest.raises(InputError, match=r"record.q is 'gyro_rad\[1\]' beside y = '-acc\[1\]'"):
        read_flight(path, *loads, rates=Rates("gyro_rad[0]", "gyro_rad[1]", "-gyro_rad[2]", "rad/s"))


def test_a_load_factor_is_specific_force_in_g(tmp_path: Path) -> None:
    path = renamed(tmp_path, n_x_g="a", n_y_g="b", n_z_g="n_z")
    columns = {"x": "a", "y": "-b", "z": "-n_z"}
    assert fly(path, **columns).summary.notes == ()
    (note,) = fly(path, quantity="acceleration", **columns).summary.notes
    assert note.startswith("'n_z' is a load factor by its name, which is specific force")
    trusting = Conditioning(skip_checks=("unit", "sign"))
    kept = read_flight(path, "time_s", *columns.values(), "m/s^2", conditioning=trusting)
    assert kept.summary.notes == ("'n_z' is a load factor by its name, which is in g, and unit is m/s^2",)

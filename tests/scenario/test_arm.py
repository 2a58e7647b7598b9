"""A plain arm in a scenario: several directions of one table, what they have of their own, and what is refused."""

import pytest

import gbeam as gb

from ..scenarios import BOX_ON_ARM

G = 9.80665
BOX = BOX_ON_ARM + 'level = "9 g"\ndwell = "60 s"\n'
SIX = 'directions = { fore = "+x", aft = "-x", left = "+y", right = "-y", up = "+z", down = "-z" }\n'
HUB = """[motion.test-up]
kind = "hub"
radius = 1
rate = { profile = "constant", level = 1 }
"""


def read(tmp_path, text, *changes):
    file = tmp_path / "arm.toml"
    file.write_text(text, encoding="utf-8")
    return gb.read_scenario(file, changes)


def test_six_directions_are_six_motions_of_their_own_time(tmp_path):
    case = read(tmp_path, BOX + SIX)
    names = [f"test-{each}" for each in ("fore", "aft", "left", "right", "up", "down")]
    assert list(case.motions) == names
    assert case.response.duration == pytest.approx(100.0)
    felt = {name: motion.base(50.0).a_WO_B / G for name, motion in case.motions.items()}
    assert felt["test-aft"] == pytest.approx([-9, 0, 1])
    assert felt["test-right"] == pytest.approx([0, -9, 1])
    assert felt["test-up"] == pytest.approx([1, 0, 9])  # +z lies along the load: +x is up


def test_a_direction_has_keys_of_its_own(tmp_path):
    directions = 'directions = { fore = "+x", up = { load = "+z", level = "6 g", onset = "1 g/s", up = "-y" } }\n'
    case = read(tmp_path, BOX + directions, "motion.test.dwell=30 s")
    up = case.motions["test-up"]
    assert up.base(30.0).a_WO_B / G == pytest.approx([0, -1, 6])
    ramp = 2.521152657241058 * 6
    assert case.spans == {"test-fore": (0.0, 70.0), "test-up": pytest.approx((0.0, 2 * ramp + 30))}
    levels = gb.describe(case).levels
    assert levels["test-up"].onset == pytest.approx(G, rel=1e-5)


def test_one_direction_keeps_the_name_of_its_motion(tmp_path):
    case = read(tmp_path, BOX + "load = [1, 0, 1]\ngravity = false\n")
    assert list(case.motions) == ["test"]
    assert case.motions["test"].base(50.0).a_WO_B / G == pytest.approx([9 / 2**0.5, 0, 9 / 2**0.5])


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "load or directions is missing"),
        (f'load = "+x"\n{SIX}', "given beside directions"),
        ('load = "+x"\nonset = "1 g/s"\n', "given beside onset"),
        ('load = "x"\n', "load"),
        ('directions = { "../up" = "+z" }\n', "'../up' is not a word"),
        ('directions = { fore = { level = "2 g" }, aft = "-x" }\n', "load is missing in the directions fore"),
        ('directions = { up = { load = "+z", up = "+z" } }\n', "up.*along load"),
        ('load = "+x"\n[response]\nduration = "30 s"\n', "comes to rest at 100 s"),
        (f"{SIX}{HUB}", "name of a direction"),
    ],
)
def test_what_is_refused_is_named(tmp_path, text, words):
    with pytest.raises(gb.InputError, match=words):
        read(tmp_path, BOX + text)


@pytest.mark.parametrize("key", ["radius", "control_point", "level", "dwell", "up"])
def test_what_is_missing_is_named_with_an_example(tmp_path, key):
    lines = [line for line in BOX.splitlines() if not line.startswith(f"{key} =")]
    with pytest.raises(gb.InputError, match=f"{key} is missing\n(.|\n)*= add {key} ="):
        read(tmp_path, "\n".join(lines) + "\n" + SIX)


ITEMS = """
[bodies.radio]
kind = "rigid"
mass = "6.5 kg"
size = ["320 mm", "200 mm", "120 mm"]
bolts = [["-140 mm", "-80 mm", 0], ["140 mm", "-80 mm", 0], ["-140 mm", "80 mm", 0], ["140 mm", "80 mm", 0]]
bolt_axis = [0, 0, 1]

[bodies.camera]
kind = "rigid"
mass = "2 kg"
size = ["100 mm", "80 mm", "60 mm"]
spread_limit = "1 %"

[joints.radio]
kind = "fixed"
body = "radio"
at = ["3 m", 0, 0]

[joints.camera]
kind = "fixed"
body = "camera"
at = ["-2.5 m", "200 mm", 0]
turn = [0, 0, "90 deg"]

[motion.test]
kind = "arm"
radius = "3 m"
control_point = ["3 m", 0, 0]
load = "-x"
up = "+z"
level = "9 g"
ramp = "5 s"
dwell = "5 s"

[response]
step = "100 ms"
"""


def test_every_item_on_an_arm_has_its_corners_and_bolts(tmp_path):
    answer = gb.study(read(tmp_path, ITEMS))
    items = {name: body.specimen for name, body in answer.responses["test"].bodies.items()}
    bolts = [(x, y, 0.0) for y in (-0.08, 0.08) for x in (-0.14, 0.14)]
    radio = gb.RigidSpecimen.box(6.5, (0.32, 0.2, 0.12), (0, 0, 0), bolts=bolts, bolt_axis=(0, 0, 1))
    alone = radio.loads(
        gb.plain_arm(radius=3.0, load="-x", up="+z", level=9 * G, ramp=5.0, dwell=5.0), duration=15.0, sample=0.1
    )
    assert items["radio"].bolt_tension == pytest.approx(alone.bolt_tension, rel=1e-6, abs=1e-9)
    assert items["radio"].bolt_compression == pytest.approx(alone.bolt_compression, rel=1e-6)
    assert items["radio"].corner_max == pytest.approx(alone.corner_max, rel=1e-6)
    # The camera sits (−2.5, 0.2) m from the axis, turned about it.
    across = 9 * G / 3.0 * (2.5**2 + 0.2**2) ** 0.5
    assert items["camera"].centre_max == pytest.approx((across**2 + G**2) ** 0.5, rel=1e-6)
    assert answer.not_accepted["test"].startswith("camera: spread")


def test_nothing_hangs_on_a_point_of_an_item(tmp_path):
    changes = "bodies.radio.points={top=[0, 0, 0.06]}", "joints.camera.on=radio.top"
    with pytest.raises(gb.InputError, match="do not say how it turns"):
        read(tmp_path, ITEMS, *changes)


def test_what_only_some_directions_lack_is_named_with_them(tmp_path):
    text = BOX.replace('level = "9 g"\n', "") + 'directions = { fore = { load = "+x", level = "2 g" }, up = "+z" }\n'
    with pytest.raises(gb.InputError, match="level is missing in the directions up"):
        read(tmp_path, text)

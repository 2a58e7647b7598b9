"""Every error path once: the message, the hint, the line, the column and what the carets stand under."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from gbeam.scenario import Diagnostic

from ..scenarios import SLEW

RATE = 'rate = { profile = "smooth-step", level = "60 rpm", duration = "2 s" }'
Z = '{ profile = "constant", level = "6 g" }'
INLINE = f"acceleration = {{ z = {Z} }}"
SPIN = "motion.spin"
ACC = "motion.flight.acceleration"

# old, new, path, message, part of the hint, text above the carets
CASES = {
    "wrong dimension": (
        'width = "20 mm"', 'width = "20 kg"', "beam.section.width",
        '"20 kg" is a mass', 'expected a length, such as "20 mm"', '"20 kg"',
    ),
    "no unit": (
        'width = "20 mm"', 'width = "20"', "beam.section.width",
        '"20" has no unit', 'add a unit, such as "20 mm", or write the bare number 20 for m', '"20"',
    ),
    "unknown unit": (
        'width = "20 mm"', 'width = "20 MM"', "beam.section.width",
        '''"20 MM" has the unknown unit 'MM\'''', "did you mean 'mm'?", '"20 MM"',
    ),
    "true for a number": (
        "damping_ratio = 0.01", "damping_ratio = true", "beam.damping_ratio",
        "true is not a number", "expected a ratio", "true",
    ),
    "infinite": (
        "damping_ratio = 0.01", "damping_ratio = inf", "beam.damping_ratio", "inf is not finite", "", "inf",
    ),
    "in a list": (
        "damping_ratio = 0.01", 'damping_ratio = [0.01, "x"]', "beam.damping_ratio[1]",
        '"x" is not a number with a unit', "expected a ratio", '"x"',
    ),
    "empty list": (
        "damping_ratio = 0.01", "damping_ratio = []", "beam.damping_ratio", "has 0 entries",
        "at least 1", "[]",
    ),
    "negative": (
        'length = "300 mm"', "length = -0.3", "beam.length", "-0.3 m is negative",
        "give a positive length", "-0.3",
    ),
    "zero": ('arm = "3.3 m"', 'arm = "0 m"', f"{SPIN}.arm", "0 m is zero", "give a positive length", '"0 m"'),
    "below zero": (
        'at = "200 mm"', 'at = "-1 mm"', "beam.masses[0].at",
        "-1 mm is negative", "give zero or a positive length", '"-1 mm"',
    ),
    "control point": (
        'control_point = "150 mm"', "control_point = 0.4", f"{SPIN}.control_point",
        "0.4 m is beyond the tip", "give 0 to 300 mm from the root", "0.4",
    ),
    "unknown key": (
        'thickness = "4 mm"', 'thickness = "4 mm", thicknes = 1', "beam.section.thicknes",
        "unknown key", "did you mean 'thickness'?", "thicknes",
    ),
    "unknown key, nothing near": (
        'title = "test"', "foo = 1", "foo", "unknown key", "the keys here are title, beam, model", "foo",
    ),
    "missing in a table": (
        'control_point = "150 mm"\n', "", SPIN, "control_point is missing",
        'add control_point = "20 mm": point of the specimen', "spin",
    ),
    "missing in an inline table": (
        ', thickness = "4 mm"', "", "beam.section", "thickness is missing", "along z", "section",
    ),
    "missing in a list": (
        ', mass = "0.1 kg"', "", "beam.masses[0]", "mass is missing", "add mass =", '{ at = "200 mm" }',
    ),
    "missing choice": (
        'profile = "constant", ', "", f"{ACC}.z", "profile is missing", "choose one of constant", "z",
    ),
    "missing kind": (
        'kind = "flight"\n', "", "motion.flight", "kind is missing", "flight, centrifuge, hub", "flight",
    ),
    "missing shape": (
        'shape = "rectangle", ', "", "beam.section", "shape is missing",
        "rectangle, circle, tube, general", "section",
    ),
    "unknown kind": (
        'kind = "hub"', 'kind = "hubb"', "motion.slew.kind", "unknown choice 'hubb'",
        "did you mean 'hub'?", '"hubb"',
    ),
    "unknown profile": (
        'profile = "constant"', 'profile = "sin"', f"{ACC}.z.profile",
        "unknown choice 'sin'", "did you mean 'sine'?", '"sin"',
    ),
    "unknown shape": (
        '"rectangle"', '"rect"', "beam.section.shape", "unknown choice 'rect'",
        "did you mean 'rectangle'?", '"rect"',
    ),
    "shape that is no text": (
        '"rectangle"', "3", "beam.section.shape", "unknown choice 3", "choose one of rectangle", "3",
    ),
    "unknown model": (
        'kind = "FOAM"', 'kind = "foam"', "model.kind", "unknown choice 'foam'", "did you mean 'FOAM'?",
        '"foam"',
    ),
    "unknown integrator": (
        'duration = "4 s"', 'duration = "4 s"\nintegrator = "newmrk"', "response.integrator",
        "unknown choice 'newmrk'", "did you mean 'newmark'?", '"newmrk"',
    ),
    "foreign parameter": (
        'duration = "4 s"', 'duration = "4 s"\nalpha = 0.1', "response.alpha",
        "does not belong to gauss", 'give integrator = "hht" with it', "alpha",
    ),
    "parameter of another": (
        'duration = "4 s"', 'duration = "4 s"\nintegrator = "newmark"\nalpha = 0.1', "response.alpha",
        "does not belong to newmark", "it takes beta and gamma", "alpha",
    ),
    "step too long": (
        'duration = "4 s"', 'duration = "4 s"\nstep = "5 s"', "response.step",
        "5 s is longer than the computation", "4 s", '"5 s"',
    ),
    "step that is no time": (
        'duration = "4 s"', 'duration = "4 s"\nstep = "automatic"', "response.step",
        '"automatic" is not a number with a unit', 'such as "16 s", or "auto"', '"automatic"',
    ),
    "no duration": (
        'duration = "4 s"\n', "", "response", "duration is missing", "no record gives one", "response",
    ),
    "not a whole number": (
        "axial = 1", "axial = 1.5", "model.modes.axial", "1.5 is not a whole number", "such as 3", "1.5",
    ),
    "number as text": (
        "axial = 1", 'axial = "1"', "model.modes.axial", "'1' is not a whole number", "such as 3", '"1"',
    ),
    "negative count": (
        "axial = 1", "axial = -1", "model.modes.axial", "-1 is negative", "give 0 or more", "-1",
    ),
    "hub without its plane": (
        "y = 1", "y = 0", "model.modes.y",
        "there is no bending shape along y, the plane of the hub 'slew'", "give y = 1 or more", "0",
    ),
    "text for true": (
        "gravity = false", 'gravity = "no"', f"{SPIN}.gravity",
        "'no' is not true or false", "write true or false, without quotes", '"no"',
    ),
    "not text": ('title = "test"', "title = 3", "title", "3 is not text", "write it in quotes", "3"),
    "not a table": (
        "modes = { axial = 1, y = 1, z = 1 }", "modes = 3", "model.modes",
        "3 is not a table", "give a table: numbers of shapes", "3",
    ),
    "not a list": (
        'masses = [ { at = "200 mm", mass = "0.1 kg" } ]', 'masses = "x"', "beam.masses",
        "'x' is not a list", "[ ..., ... ]", '"x"',
    ),
    "short vector": (
        'mass = "0.1 kg"', 'mass = "0.1 kg", offset = [0, 0]', "beam.masses[0].offset",
        "has 2 entries", "give three: x, y and z", "[0, 0]",
    ),
    "tracks a hub": (
        'tracks = "flight"', 'tracks = "slew"', f"{SPIN}.tracks", "'slew' names a hub, not a flight",
        "", '"slew"',
    ),
    "tracks nothing": (
        'tracks = "flight"', 'tracks = "fligth"', f"{SPIN}.tracks",
        "'fligth' names no motion", "did you mean 'flight'?", '"fligth"',
    ),
    "unknown inverse": (
        'inverse = "flat"', 'inverse = "flatt"', f"{SPIN}.inverse", "unknown choice 'flatt'", "'flat'?",
        '"flatt"',
    ),
    "no component": (INLINE, "acceleration = {}", ACC, "has no component", "one or more of x, y and z", "{}"),
    "neither source": (
        INLINE + "\n", "", "motion.flight", "record or acceleration is missing", "add one of them", "flight",
    ),
    "unit of a level": (
        '"60 rpm"', '"6 g"', "motion.slew.rate.level", '"6 g" is a mass', "expected an angular rate", '"6 g"',
    ),
    "unit of a jerk": (
        Z, '{ profile = "trapezoid", level = 1, jerk = "4 g", start = 0, hold = 1 }', f"{ACC}.z.jerk",
        '"4 g" is an acceleration', "expected a jerk, such as", '"4 g"',
    ),
    "in a term": (
        Z, f'{{ profile = "sum", terms = [ {Z}, {{ profile = "constant", level = "6 m" }} ] }}',
        f"{ACC}.z.terms[1].level", '"6 m" is a length', "expected an acceleration", '"6 m"',
    ),
    "name of a motion": (
        "[motion.slew]", '[motion."my hub"]', "motion.my hub",
        "'my hub' is not a word", "letters, digits, _ and -", '"my hub"',
    ),
}  # fmt: skip
# Rules of the objects: the scenario only puts their words at the right place.
BUILT = {
    "beyond the tip": (
        'at = "200 mm"', 'at = "400 mm"', "beam.masses[0].at",
        "is 0.4 m, beyond the tip", "give 0 to 0.3 m from the root", '"400 mm"',
    ),
    "station": (
        'duration = "4 s"', 'duration = "4 s"\nstations = [0.1, "310 mm"]', "response.stations[1]",
        "is 0.31 m, off the beam", "give 0 to 0.3 m", '"310 mm"',
    ),
    "residual too late": (
        'duration = "4 s"', 'duration = "4 s"\nresidual_from = "5 s"', "response.residual_from",
        "is 5 s", "give a time from 0 s on, before 4 s", '"5 s"',
    ),
    "SFOAM": (
        'kind = "FOAM"', 'kind = "SFOAM"', "model.modes.axial",
        "is 1 for SFOAM, which has no axial coordinates", "give 0, or use FOAM", "1",
    ),
    "rate and torque": (
        RATE, RATE + '\ninertia = 1\ntorque = { profile = "constant", level = 1 }', "motion.slew.torque",
        "is given beside rate", "keep rate or torque, not both", "torque",
    ),
    "torque without inertia": (
        RATE, 'torque = { profile = "constant", level = "1 N m" }', "motion.slew.inertia",
        "is missing", 'inertia = "200 kg m^2"', "slew",
    ),
    "table of unequal lists": (
        Z, '{ profile = "table", times = [0, 1], values = [1, 2, 3] }', f"{ACC}.z.values",
        "has 3 entries for 2 times", "give one value per time", "[1, 2, 3]",
    ),
    "table out of order": (
        Z, '{ profile = "table", times = [0, "2 s", "1 s"], values = [1, 2, 3] }', f"{ACC}.z.times[2]",
        "is 1 s, after 2 s", "list times in strictly increasing order", '"1 s"',
    ),
    "stations of a section": (
        'shape = "rectangle"', 'shape = "rectangle", stations = [0, 0.2]', "beam.section.stations",
        "cover 0 to 0.2 m", "start at the root", "[0, 0.2]",
    ),
    "dimensions and stations": (
        'width = "20 mm"', "width = [0.02, 0.01]", "beam.section.width",
        "has 2 value(s) for 1 station(s)", "one value per station", "[0.02, 0.01]",
    ),
    "wall of a tube": (
        'shape = "rectangle", width = "20 mm", thickness = "4 mm"',
        'shape = "tube", diameter = "20 mm", wall = "11 mm"', "beam.section.wall",
        "is 0.011 m", "at most half the diameter", '"11 mm"',
    ),
    "rigid body": (
        'mass = "0.1 kg"', 'mass = "0.1 kg", inertia = { x = 1, y = 1, z = 9 }', "beam.masses[0].inertia",
        "is (1.0, 1.0, 9.0) kg m²", "no moment of a rigid body", "{ x = 1, y = 1, z = 9 }",
    ),
    "damping": (
        "damping_ratio = 0.01", 'damping_ratio = "150 %"', "beam.damping_ratio", "is 1.5", "up to 1",
        '"150 %"',
    ),
    "parameter": (
        'duration = "4 s"', 'duration = "4 s"\nintegrator = "hht"\nalpha = 0.1', "response.alpha",
        "is 0.1", "from -1/3 to 0", "0.1",
    ),
    "profile": (
        Z, '{ profile = "trapezoid", level = 0, jerk = 1, start = 0, hold = 1 }', f"{ACC}.z.level",
        "is 0", "other than zero", "0",
    ),
    "idle": (
        "gravity = false", 'gravity = true\nidle = "1 g"', f"{SPIN}.idle",
        "is 1 g", "give at least 1.1 g", '"1 g"',
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_is_refused_at_its_place(case: tuple[str, ...], refused: Callable[..., None]) -> None:
    refused(*case)


@pytest.mark.parametrize("case", BUILT.values(), ids=BUILT)
def test_is_refused_by_the_core(case: tuple[str, ...], refused: Callable[..., None]) -> None:
    refused(*case, building=True)


def test_no_shapes_at_all(text: str, errors: Callable[..., tuple[Diagnostic, ...]]) -> None:
    (error,) = errors(
        text.replace("axial = 1, y = 1, z = 1", "axial = 0, y = 0, z = 0").replace(SLEW, ""), building=True
    )
    assert (error.path, error.message) == ("model.modes", "are all zero")
    assert error.hint == "give at least one mode in one direction"
    assert error.source_line == "modes = { axial = 0, y = 0, z = 0 }"

"""The texts of scenarios that tests share: two beams, what their bases do, and the scenarios put together from them.

A test that needs another one replaces a stretch of the text, or sets it by ``--set``.
"""

from __future__ import annotations

# The specimen of Zhang 2020.
SPECIMEN = """\
[beam]
length = "300 mm"
section = { shape = "rectangle", width = "20 mm", thickness = "4 mm" }
material = { density = "2700 kg/m^3", youngs_modulus = "70 GPa" }
damping_ratio = 0.01
"""
# The appendage of 2009, Table 1.
APPENDAGE = """\
[beam]
length = "8 m"
section = { area = "7.2968e-5 m^2", inertia_y = "8.2189e-9 m^4", inertia_z = "8.2189e-9 m^4" }
material = { density = "2766.7 kg/m^3", youngs_modulus = "6.8952e10 Pa" }
damping_ratio = 0
"""
FLIGHT = """\
[motion.flight]
kind = "flight"
acceleration = { z = { profile = "constant", level = "6 g" } }
"""
SPIN = """\
[motion.spin]
kind = "centrifuge"
tracks = "flight"
arm = "3.3 m"
control_point = "150 mm"
inverse = "flat"
gravity = false
"""
SLEW = """\
[motion.slew]
kind = "hub"
radius = "0.5 m"
rate = { profile = "smooth-step", level = "60 rpm", duration = "2 s" }
"""
TORQUE = """\
[motion.slew]
kind = "hub"
radius = "0.5 m"
inertia = "200 kg m^2"
torque = { profile = "sine", amplitude = "50 N m", duration = "2 s" }
"""


def model(kind: str, axial: int, y: int, z: int) -> str:
    """The table [model]."""
    return f'[model]\nkind = "{kind}"\nmodes = {{ axial = {axial}, y = {y}, z = {z} }}\n'


def response(duration: str, **more: str) -> str:
    """The table [response]; quantities as text."""
    lines = [f'{key} = "{value}"' for key, value in {"duration": duration, **more}.items()]
    return "\n".join(["[response]", *lines, ""])


BOX_ON_ARM = """
[bodies.box]
kind = "rigid"
mass = "6.5 kg"
size = ["320 mm", "200 mm", "120 mm"]

[motion.test]
kind = "arm"
radius = "3.3 m"
control_point = [0, 0, 0]
ramp = "20 s"
up = ["+z", "+x"]
"""
# Every kind of motion, and a mass; its lines are counted by the tests of error messages.
EVERY_MOTION = (
    'title = "test"\n'
    + SPECIMEN
    + 'masses = [ { at = "200 mm", mass = "0.1 kg" } ]\n'
    + model("FOAM", 1, 1, 1)
    + FLIGHT
    + SPIN
    + SLEW
    + response("4 s")
)
# A flight and its centrifuge, computed in a moment: up and down in half the time that it would take, from 2 g on.
RAMPS = 'spin_up = "1.3 s"\nspin_down = "1.3 s"\n'
FAST = 'title = "fast"\n' + SPECIMEN + model("FOAM", 0, 1, 1) + FLIGHT + SPIN + RAMPS + response("0.5 s")
# The same, without the runs by which its errors would be estimated: most tests do not read them.
UNJUDGED = FAST + "estimate = false\n"
# A free hub.
FREE_HUB = 'title = "hub"\n' + APPENDAGE + model("FOAM", 1, 1, 0) + TORQUE + response("4 s", residual_from="2 s")
# A hub that slews; the linear model loses its equilibrium at 2.91 rad/s.
SLEWING = (
    'title = "hub"\n'
    + APPENDAGE
    + model("TLAM", 1, 3, 0)
    + SLEW.replace("60 rpm", "2 rad/s").replace("2 s", "30 s")
    + response("35 s")
)
SLEWING_AND_FLYING = SLEWING + FLIGHT.replace("z = ", "y = ").replace("6 g", "0.1 g")
# A column under a following load at its tip, on a hub that stands still and in a flight without acceleration.
COLUMN = (
    APPENDAGE
    + """\
[[beam.loads]]
at = "8 m"
force = { x = { profile = "smooth-step", level = "-1 N", duration = "1 s" } }
follower = true
"""
    + model("TLAM", 1, 5, 0)
    + SLEW.replace('"smooth-step", level = "60 rpm", duration = "2 s"', '"constant", level = "0 rad/s"')
    + FLIGHT.replace("z = ", "y = ").replace("6 g", "0 g")
    + response("2 s")
)
# As many kinds of value as a scenario can hold, for junk to be put into.
MANY_KINDS = (
    'title = "test"\n'
    + SPECIMEN.replace('thickness = "4 mm"', 'thickness = ["4 mm", "3 mm"], stations = [0, "300 mm"]').replace(
        "damping_ratio = 0.01", "damping_ratio = [0.01]"
    )
    + 'masses = [ { at = 0.2, mass = "0.1 kg", inertia = { x = 1, y = 1, z = 1 }, offset = [0, 0, 0] } ]\n'
    + model("FOAM", 1, 1, 1)
    + FLIGHT.replace(
        '{ profile = "constant", level = "6 g" }',
        '{ profile = "sum", terms = [ { profile = "table", times = [0, 1], values = [1, 2] } ] }',
    )
    + SPIN
    + TORQUE.replace('"200 kg m^2"', "1").replace("50 N m", "6 N m")
    + response("4 s")
)

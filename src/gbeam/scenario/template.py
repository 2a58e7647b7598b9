"""Commented scenarios to start from, and the JSON schema of scenarios for editors."""

from __future__ import annotations

import json
from typing import Any

from gbeam.errors import InputError
from gbeam.printable import advise
from gbeam.scenario.schema import Environments, Scenario
from gbeam.scenario.values import FAMILIES

_HEAD = """\
# A scenario for gbeam. Quantities are text with a unit ("300 mm", "6 g", "60 rpm"); bare numbers are SI.
# Axes: x along the beam, y along its width, z through its thickness. Every key, with its unit and default:
# `gbeam schema --markdown`, or docs/scenario.md.
"""

_FLIGHT = """\
title = "A beam in flight and on a centrifuge"

[beam]
length = "300 mm"
# or: { shape = "circle", diameter = "10 mm" }, { shape = "tube", diameter = "10 mm", wall = "1 mm" },
# { area = "80 mm^2", inertia_y = "107 mm^4", inertia_z = "2667 mm^4" }. A taper lists dimensions at
# stations = ["0 mm", "300 mm"].
section = { shape = "rectangle", width = "20 mm", thickness = "4 mm" }
material = { density = "2700 kg/m^3", youngs_modulus = "70 GPa" }  # yield_strength = "270 MPa" in it gives margins
damping_ratio = 0.01  # of critical; a list gives one per mode
# masses = [ { at = "300 mm", mass = "0.1 kg" } ]
# root = { rotation_y = "500 N m/rad" }  # springs instead of a perfect clamp; what is left out is rigid
# loads = [ { at = "300 mm", force = { z = "5 N" }, follower = false } ]  # moment likewise; or { distributed = ... }

[model]
kind = "FOAM"  # TLAM | FOAM | SFOAM | CFOAM | fourth-order | exact
modes = { axial = 1, y = 3, z = 3 }
# shapes = "adapted"  # modes of this beam with its tapers, masses and root springs: fewer are needed

# What the base does: as many [motion.NAME] as you like, each an environment for the same beam.
[motion.flight]
kind = "flight"
# A measured record, in place of [motion.flight.acceleration.z] below, which goes, as does duration under [response]:
# a CSV file beside this one; "-" in front changes a sign; from = "2 s" and to = "9 s" in it ask for a part.
# record = { file = "flight.csv", time = "time_s", x = "n_x_g", y = "-n_y_g", z = "-n_z_g", unit = "g" }

# Up at the jerk to the level, hold, down again; on top of a constant load that the machine can hold.
[motion.flight.acceleration.z]
profile = "sum"
terms = [
  { profile = "constant", level = "1.5 g" },
  { profile = "trapezoid", level = "4.5 g", jerk = "4 g/s", start = "1 s", hold = "2 s" },
]

# What the centrifuge does so that the control point feels the same: from standstill to standstill.
[motion.centrifuge]
kind = "centrifuge"
tracks = "flight"  # the motion it imitates
machine = "specimen-3.3m"  # an example: arm, idle and limits. Of your own: arm = "3.3 m", and under limits below
# point of the beam that feels the flight's load, from the root: by `gbeam place`, which writes it here with --write
control_point = "220 mm"
gravity = true  # the target is specific force (what accelerometers measure); gravity is there on the machine
idle = "1.4 g"  # the arm never makes less: below it the flight is not followed
# inverse = "planned"  # within the limits, least error; or the textbook's "flat", "exact", "quasi-static"
# mounting = "inverted"  # its tip trails the arm's motion; "upright": it leads
# start = "pre-yawed"  # axis 2 begins across the arm; or "idle": the arm turns already
# spin_up = "10 s"  # before the flight, and spin_down after it; left out, found within the limits
smoothing = "60 ms"  # width of the kernel that rounds the corners of the load to be followed
# commands = { sample = "5 ms" }  # of the axes, for the controller: `gbeam plan --out DIR` writes them

# [motion.centrifuge.limits]
# axis1 = { rate = "74 rpm", acceleration = "21 rad/s^2", jerk = "210 rad/s^3" }  # likewise axis2 (yaw), axis3 (roll)
# power = "50 kW"  # of the arm, with inertia = "2000 kg m^2"

# What counts as a good imitation: anything else ends in exit status 1.
[motion.centrifuge.accept]
tip = "2 %"  # change of the tip's peak displacement; likewise root_force, root_moment, stress
root_moment = "5 %"
peaks = "3 %"  # error of every peak of the load above idle
# largest_load = "10 %"  # change of the largest load anywhere on the specimen; followed = "90 %" of the time
# srs = "3 dB"  # of the tip's shock response spectra; damage = 2; spread, tolerance: docs/verdict.md

[response]
duration = "6 s"  # of the profile above; leave it out beside a record, which is flown to its end
stations = ["100 mm", "200 mm", "300 mm"]  # positions from the root for the output
step = "auto"
integrator = "gauss"  # gauss | newmark | hht | generalized-alpha
"""

_HUB = """\
title = "A flexible appendage on a hub that slews"

[beam]
length = "8 m"
section = { area = "72.968 mm^2", inertia_y = "8218.9 mm^4", inertia_z = "8218.9 mm^4" }
# or by shape: { shape = "rectangle", width = "20 mm", thickness = "4 mm" }, circle, tube
material = { density = "2766.7 kg/m^3", youngs_modulus = "68.952 GPa" }
damping_ratio = 0  # of critical; a list gives one per mode
masses = [ { at = "8 m", mass = "0.1 kg" } ]

[model]
kind = "FOAM"  # TLAM | FOAM | SFOAM | CFOAM | fourth-order | exact
modes = { axial = 2, y = 3, z = 0 }  # the hub turns about z: the beam bends along y

[motion.slew]
kind = "hub"
radius = "0.5 m"
rate = { profile = "smooth-step", level = "2 rad/s", duration = "30 s" }
# or a free hub under a torque, instead of the rate:
# inertia = "200 kg m^2"
# torque = { profile = "sine", amplitude = "50 N m", duration = "10 s" }
# stiffness = "50 N m/rad"  # and damping = "2 N m s/rad": from a free hub to the ground
# pointing = "inward"  # setting_angle = "30 deg" turns the section about the beam
# gravity = [0, 0, "-1 g"]  # in hub axes at hub angle zero: z is the hub's axis

[response]
duration = "50 s"
residual_from = "30 s"  # the vibration left after the manoeuvre is measured from here to the end
step = "auto"
integrator = "gauss"  # gauss | newmark | hht | generalized-alpha
"""

_SYSTEM = """\
title = "A satellite with a flexible panel, pointed by its wheel"

# Bodies, each rigid or a beam, in axes of its root.
[bodies.bus]
kind = "rigid"
mass = "100 kg"
inertia = ["40 kg m^2", "50 kg m^2", "60 kg m^2"]  # principal moments about the centre of mass, or three rows
# centre = ["0 m", "0 m", "0 m"]  # of mass, from the root
points = { side = { at = ["0.5 m", 0, 0], turn = ["90 deg", 0, 0] } }  # places with axes, on which others hang

[bodies.panel]
kind = "beam"  # the keys of [beam], and its model
length = "3 m"
section = { shape = "rectangle", width = "0.5 m", thickness = "20 mm" }
material = { density = "2700 kg/m^3", youngs_modulus = "70 GPa" }  # yield_strength = "270 MPa" in it gives margins
damping_ratio = 0.005
points = [ { name = "middle", at = "1.5 m" } ]  # besides tip and root
# stations = ["1 m", "2 m"]  # further sections with loads and stress
model = { kind = "FOAM", modes = { axial = 0, y = 0, z = 3 } }  # exact | fourth-order | CFOAM | FOAM | TLAM

# One joint for every body, which holds it by its root.
[joints.axis]
kind = "revolute"  # fixed | revolute | prismatic | cylindrical | universal | spherical | free
body = "bus"
on = "ground"  # or a point of another body
axes = [[0, 0, 1]]
initial = "-0.3 rad"
# rate = { profile = "smooth-step", level = "10 deg/s", duration = "5 s" }  # prescribed, instead of free
# effort = "2 N m"  # of a drive; stiffness, ease, damping, friction, stops with stop_stiffness

[joints.clamp]
kind = "fixed"  # stiffness = { rz = "2 kN m/rad" } lets it give way
body = "panel"
on = "bus.side"

# Forces and moments on points, in axes of the ground, or of the point with follower = true.
# [forces.thruster]
# on = "panel.tip"
# force = { y = "1 N" }  # moment likewise; each a quantity or a profile

# Controllers sample, and hold their efforts; laws one after the other: pid, lead-lag, notch, gains, state-space.
[controllers.pointing]
measure = ["axis.angle"]
drive = ["axis.angle"]
law = [{ kind = "pid", kp = 60, kd = 220, smoothing = "100 ms" }]  # in SI units of effort and measurement
sample = "20 ms"
# delay = "20 ms"
limit = [20]  # N m

# [system]
# gravity = [0, 0, "-1 g"]
# The ground rests, or moves as [motion.NAME] says: a flight, a centrifuge, a hub of a given rate.

[response]
duration = "20 s"
"""

_ARM = """\
title = "A box on a plain arm, in six directions"

[bodies.box]
kind = "rigid"
mass = "5 kg"
size = ["300 mm", "200 mm", "120 mm"]  # of the box, along x, y and z
middle = [0, 0, "60 mm"]  # of the box, from the root: where its axes begin, in the plane of the bolts
centre = ["0 mm", "0 mm", "60 mm"]  # of mass, from there
# inertia = ["0.03 kg m^2", "0.05 kg m^2", "0.06 kg m^2"]  # about it; that of an even box where it is left out
bolts = [["-130 mm", "-80 mm", 0], ["130 mm", "-80 mm", 0], ["-130 mm", "80 mm", 0], ["130 mm", "80 mm", 0]]
bolt_axis = [0, 0, 1]  # away from the fixture
spread_limit = "10 %"  # of the load over the box, of the test order; beyond it the run is not accepted

[motion.test]
kind = "arm"
# preset = "mil-std-810h-513-structural"  # `gbeam presets` lists tests of standards
radius = "3 m"  # from the arm's axis to the control point, where the level holds
control_point = [0, 0, "60 mm"]  # from the root
level = "9 g"  # centripetal, at the control point; the weight comes on top unless gravity = false
onset = "0.5 g/s"  # the largest; or ramp = "20 s", the time to the level
dwell = "60 s"
# down = "30 s"  # time from the level to rest; as long as that up where it is left out
up = ["+z", "+x"]  # what is up: the first of these that does not lie along the load

# Directions of the box that point to the arm's axis, by name: the arm accelerates it that way. Each is a motion,
# test-fore and so on, and may have keys of its own. For one direction alone load = "+x" in [motion.test] instead.
[motion.test.directions]
fore = "+x"
aft = "-x"
left = "+y"
right = "-y"
up = { load = "+z", level = "6 g" }
down = "-z"

[response]  # each direction over its own time
step = "100 ms"
"""

_TEMPLATES = {"flight": _FLIGHT, "hub": _HUB, "arm": _ARM, "system": _SYSTEM}


def template(kind: str) -> str:
    """Return the text of a commented scenario that runs as it is."""
    if kind not in _TEMPLATES:
        raise InputError("kind", f"is {kind!r}, of which there is no template", advise(kind, _TEMPLATES))
    return _HEAD + _TEMPLATES[kind]


def _allow_distributions(node: Any) -> None:
    """Add a distribution, in place, to the alternatives of every quantity in a schema."""
    if isinstance(node, dict):
        for value in node.values():
            _allow_distributions(value)
        if "x-quantity" in node and "anyOf" in node:
            node["anyOf"] = [*node["anyOf"], {"$ref": "#/$defs/Distribution"}]
    elif isinstance(node, list):
        for value in node:
            _allow_distributions(value)


def _distribution_schema() -> dict[str, Any]:
    """Schema of a table with one key, the family, whose value is the list of its numbers."""
    numbers = {"type": "array", "items": {"type": ["number", "string"]}}
    families = {}
    for name, family in FAMILIES.items():
        count = len(family.arguments)
        families[name] = numbers | {
            "minItems": count, "maxItems": count, "description": ", ".join(family.arguments),
        }  # fmt: skip
    head = {"title": "Distribution", "description": "what gbeam sweep draws from; other verbs need one value"}
    one = {"type": "object", "minProperties": 1, "maxProperties": 1, "additionalProperties": False}
    return {**head, **one, "properties": families}


def json_schema(*, distributions: bool = True) -> str:
    """Return the JSON schema of a scenario: every field with its description, quantity and SI unit."""
    from pydantic.json_schema import models_json_schema

    from gbeam.scenario.schema.system import SpecimenScenario, SystemScenario

    kinds: tuple[type[Environments], ...] = (Scenario, SystemScenario, SpecimenScenario)
    _, schema = models_json_schema([(kind, "validation") for kind in kinds], title="Scenario")
    tables = [schema["$defs"].pop(kind.__name__) for kind in kinds]
    schema |= {"type": "object", "additionalProperties": False, "description": "A scenario, in SI or with units."}
    schema["anyOf"] = [{"required": table["required"]} for table in tables]
    properties: dict[str, Any] = {}
    for table in tables:
        properties |= {key: value for key, value in table["properties"].items() if key not in properties}
    schema["properties"] = properties
    if distributions:
        _allow_distributions(schema)
        schema["$defs"]["Distribution"] = _distribution_schema()
    text = json.dumps(schema, indent=2, ensure_ascii=False)
    for name, table in schema["$defs"].items():  # of profiles, whose titles have spaces
        text = text.replace(f'"{name}"', f'"{table["title"].replace(" ", "-")}"').replace(
            f'/{name}"', f'/{table["title"].replace(" ", "-")}"'
        )
    return text

"""One small specimen of every kind, as scenarios that a user would write: on a base that moves, and on a joint."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import meshio
import numpy as np

from tests.solids.bodies import block
from tests.solids.test_matrices import frame

TITLE = 'title = "a specimen"\n'
RESPONSE = '[response]\nduration = "0.04 s"\nstep = "2 ms"\nestimate = false\n'
FLIGHT = """
[motion.flight]
kind = "flight"
acceleration = { z = { profile = "table", times = [0, "20 ms", "1 s"], values = ["2 g", "3 g", "3 g"] } }
"""
MACHINE = """
[motion.machine]
kind = "centrifuge"
tracks = "flight"
arm = "3 m"
control_point = "50 mm"
gravity = false
spin_up = "1.3 s"
spin_down = "1.3 s"
"""
HUB = """
[motion.hub]
kind = "hub"
radius = "0.3 m"
rate = { profile = "smooth-step", level = "60 rpm", duration = "20 ms" }
"""
HINGE = """
[joints.hinge]
kind = "revolute"
body = "{name}"
axes = [[0, 0, 1]]
rate = {{ profile = "smooth-step", level = "60 rpm", duration = "20 ms" }}
"""
DRIVEN = """
[joints.hinge]
kind = "revolute"
body = "{name}"
axes = [[0, 0, 1]]
stiffness = 50.0
damping = 0.5

[controllers.damper]
measure = ["{measure}"]
drive = ["{drive}"]
law = [{{ kind = "pid", kp = -0.1 }}]
sample = "5 ms"
"""
METAL = 'material = { density = "2700 kg/m^3", youngs_modulus = "70 GPa", poissons_ratio = 0.33 }\n'
STRIP = 'section = { shape = "rectangle", width = "20 mm", thickness = "4 mm" }\ndamping_ratio = 0.01\n' + METAL
LINE = (
    'line = { pieces = [ { length = "60 mm" }, { length = "31.416 mm", turn_y = "-90 deg" }, { length = "60 mm" } ] }\n'
)


@dataclass(frozen=True)
class Kind:
    """A kind of specimen: tables of its bodies, and the paths by which studies name what is its."""

    name: str
    bodies: str
    last: str  # the body that is read of
    value: str  # path of a value that may vary
    point: str  # a named point
    figure: str  # of a run
    joints: str = ""  # of several bodies, which stand on no base
    turns: str = "hinge.angle"  # by a rate, or a force that acts
    felt: str = "hinge.angle_rate"  # by a controller that drives that
    measured: str = "tip.z"  # a history to which a value is fitted
    held: bool = True  # by a base or the ground
    modes: str = ""  # what says the numbers of shapes; empty of what has none to choose
    written: dict[str, str] = field(default_factory=dict)

    def moved(self, *motions: str) -> str:
        """The scenario in motions of the base."""
        return TITLE + self.bodies + self.joints + "".join(motions) + RESPONSE

    def alone(self) -> str:
        """The scenario in a flight, of what nothing holds in nothing."""
        return self.moved(FLIGHT) if self.held else self.moved()

    def turned(self) -> str:
        """The scenario on a hub, of several bodies on the ground, where a joint turns."""
        return self.moved() if self.joints else self.moved(HUB)

    def controlled(self) -> str:
        """The scenario with a controller of what turns or pushes it."""
        joints = self.joints.replace("rate = ", "# rate = ") or DRIVEN.partition("[controllers")[0].format(
            name=self.last
        )
        law = "[controllers" + DRIVEN.partition("[controllers")[2].format(measure=self.felt, drive=self.turns)
        return TITLE + self.bodies + joints + law + RESPONSE


def _beam(name: str, more: str = 'length = "0.15 m"\n') -> str:
    model = 'model = { kind = "FOAM", modes = { axial = 0, y = 1, z = 1 } }\n'
    return f'[bodies.{name}]\nkind = "beam"\n{more}{STRIP}{model}'


_MODES = "modes = { axial = 0, y = 1, z = 1 }"
_ARM = """
[bodies.upper]
kind = "rigid"
mass = "2 kg"
inertia = [0.01, 0.02, 0.02]
centre = ["0.1 m", 0, 0]
points = { elbow = { at = ["0.2 m", 0, 0] } }
""" + _beam("strip")
_ARM_JOINTS = """
[joints.base]
kind = "revolute"
body = "upper"
axes = [[0, 0, 1]]
rate = { profile = "smooth-step", level = "60 rpm", duration = "20 ms" }

[joints.elbow]
kind = "revolute"
body = "strip"
on = "upper.elbow"
axes = [[0, 0, 1]]
stiffness = 20.0
damping = 0.05
"""
_SATELLITE = """
[bodies.hub]
kind = "rigid"
mass = "20 kg"
inertia = [1.0, 1.0, 1.0]
points = { rim = { at = ["0.2 m", 0, 0] } }
""" + _beam("panel", 'length = "0.5 m"\n')
_SATELLITE_JOINTS = """
[joints.orbit]
kind = "free"
body = "hub"

[joints.clamp]
kind = "fixed"
body = "panel"
on = "hub.rim"

[forces.thrust]
on = "hub.rim"
force = { z = { profile = "sine", amplitude = "1 N", duration = "20 ms" } }
"""
_RUN = "motions.flight.tip.size.max_abs"
KINDS = (
    Kind(
        "beam", _beam("strip"), "strip", "bodies.strip.material.youngs_modulus", "tip", _RUN, modes=_MODES
    ),
    Kind(
        "curved beam", _beam("strip", LINE), "strip", "bodies.strip.material.youngs_modulus", "tip", _RUN, modes=_MODES
    ),
    Kind(
        "mesh",
        '[bodies.plate]\nmesh = "plate.inp"\nunit = "m"\nclamp = "wall"\nmodes = 3\ndamping_ratio = 0.01\n'
        + 'points = { tip = [0.2, 0, 0] }\n' + METAL,
        "plate", "bodies.plate.material.youngs_modulus", "tip", _RUN, modes="modes = 3",
    ),
    Kind(
        "matrices",
        '[bodies.frame]\nmatrices = "frame.npz"\nclamp = [0]\nmodes = 3\ndamping_ratio = 0.01\npoints = { tip = 4 }\n',
        "frame", "bodies.frame.damping_ratio", "tip", _RUN, modes="modes = 3",
    ),
    Kind(
        "rigid box",
        '[bodies.box]\nkind = "rigid"\nmass = "3 kg"\nsize = ["0.2 m", "0.1 m", "0.1 m"]\n'
        + 'inertia = [0.005, 0.01, 0.01]\ncentre = [0, 0, "50 mm"]\n'
        + 'points = { lid = { at = ["0.1 m", 0, "0.1 m"] } }\n',
        "box", "bodies.box.mass", "lid", "motions.flight.specimen.largest_load.size",
        measured="root_force.z",
    ),
    Kind(
        "robot arm", _ARM, "strip", "bodies.strip.material.youngs_modulus", "strip.tip",
        "motions.flight.points.strip.tip.displacement_max", _ARM_JOINTS, "base.angle",
        "base.angle_rate", "strip.tip.place_y", modes=_MODES,
    ),
    Kind(
        "free satellite", _SATELLITE, "panel", "bodies.panel.material.youngs_modulus", "panel.tip",
        "motions.ground.points.panel.tip.displacement_max", _SATELLITE_JOINTS,
        "thrust.force_z", "hub.rim.velocity_z", "panel.tip.place_z", held=False, modes=_MODES,
    ),
)  # fmt: skip


def write(folder: Path) -> None:
    """Write the mesh and the matrices that scenarios name."""
    mass, stiffness, nodes = frame(4)
    np.savez(folder / "frame.npz", M=mass, K=stiffness, nodes=nodes)
    meshio.write(folder / "plate.inp", block("hexahedron20", (3, 1, 1), (0.2, 0.02, 0.01)))

"""Systems: bodies by name, the joints that hold them, gravity, and forces at points."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated

import numpy as np

from gbeam.arrays.namespace import Array, as_array, concatenated, holds_jax, namespace
from gbeam.arrays.tree import Value, assign, follows
from gbeam.arrays.types import Floats, Numbers
from gbeam.errors import InputError, naming
from gbeam.guards.arguments import typed
from gbeam.guards.checks import choice, vector
from gbeam.guards.quantities import AccelerationVector, Components, Quantity, Seconds, Times
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.tree.body_terms import body_of, refuse_turnless, stations_of
from gbeam.mechanics.tree.control import Feedback
from gbeam.mechanics.tree.course import Course
from gbeam.mechanics.tree.equations import Force, Inputs, Link, State, Tree
from gbeam.mechanics.tree.frames import Frame
from gbeam.mechanics.tree.joints import GROUND, Joint
from gbeam.mechanics.tree.rigid_body import ROOT, RigidBody
from gbeam.mechanics.tree.signals import drives_of, measurable
from gbeam.motion.hub import Hub
from gbeam.motion.profiles.combine import as_profile
from gbeam.motion.profiles.profile import Profile
from gbeam.motion.protocol import Motion
from gbeam.printable import advise

CLAMP = "clamp"  # joint of a system of one body
Prescribed = tuple[str, tuple[int, ...], tuple[str, ...]]


@typed
@dataclass(frozen=True, eq=False)
class PointForce(Value):
    """A force and a moment on a point of a system, such as thrust.

    Attributes
    ----------
    history : (Profile, Profile)
        Force and moment over time.

    Examples
    --------
    >>> gb.PointForce("bus.nozzle", force=(0, 0, 20.0), follower=True).on
    'bus.nozzle'
    """

    on: Annotated[str, 'the point: "bus.nozzle"']
    force: Annotated[
        Numbers | Profile | None,
        Quantity("force"),
        Components(
            "A force on a point by components, each a quantity or a profile; those left out are zero.",
            x="component along x",
            y="component along y",
            z="component along z",
        ),
        "force on the point: { x, y, z }",
    ] = None
    moment: Annotated[
        Numbers | Profile | None,
        Quantity("torque"),
        Components(
            "A moment on a point by components, each a quantity or a profile; those left out are zero.",
            x="component about x",
            y="component about y",
            z="component about z",
        ),
        "moment on the point: { x, y, z }",
    ] = None
    follower: Annotated[bool, "true if the components turn with the point; false if they keep to the ground's axes"] = (
        False
    )
    history: tuple[Profile, Profile] = follows()

    def __post_init__(self) -> None:
        zero = (0.0, 0.0, 0.0)
        force = as_profile("force", zero if self.force is None else self.force, 3)
        moment = as_profile("moment", zero if self.moment is None else self.moment, 3)
        assign(self, history=(force, moment))


@typed
@dataclass(frozen=True, eq=False)
class System(Value):
    """Bodies joined to a tree: rigid bodies and flexible structures, on the ground, on a moving base, or free.

    Attributes
    ----------
    order : tuple of str
        Names of the bodies, each after the one that it hangs on.
    points : tuple of str
        Names of all points, as ``body.point``.
    coordinates, unknown_coordinates : tuple of str
        Names of all coordinates, those of the joints and numbered ones of the bodies that deform, and of those that
        nothing prescribes.
    flexible : dict of str to Structure
        Bodies that deform, by name.
    holding : dict of str to str
        Name of the joint that holds each body.
    prescribed : list of (str, tuple of int, tuple of str)
        Coordinates that are prescribed together, one, or a ball's four: name of the joint, indices among its
        coordinates, and names of the rates.
    tree : Tree
        The equations.
    courses : dict of str to Course
        Attitude over time of each ball whose spin is prescribed, by the joint's name.

    Raises
    ------
    InputError
        If a body hangs on nothing, on two joints, or on a point that is not there, joints make a loop, or an SFOAM's
        root moves by unknowns.

    Examples
    --------
    >>> rod = gb.RigidBody(1.0, (0.0, 1 / 12, 1 / 12), centre=(0.5, 0, 0), points={"end": (1, 0, 0)})
    >>> pendulum = gb.System(
    ...     {"upper": rod, "lower": rod},
    ...     {
    ...         "top": gb.Joint("revolute", "upper", axes=[(0, 1, 0)], initial=0.3),
    ...         "elbow": gb.Joint("revolute", "lower", on="upper.end", axes=[(0, 1, 0)]),
    ...     },
    ...     gravity=(0, 0, -9.81),
    ... )
    >>> pendulum.coordinates
    ('top.angle', 'elbow.angle')
    """

    bodies: Annotated[
        Mapping[str, RigidBody | Structure],
        "bodies by name. Structures are those of :func:`gbeam.assemble` and :meth:`Structure.of_particles`, SFOAM only "
        "where joints prescribe how its root moves; their points are the named points of the beam, and ``tip``",
    ]
    joints: Annotated[Mapping[str, Joint], "one for every body, which holds it by its root"]
    forces: Annotated[Mapping[str, PointForce], "forces and moments on points, beside the loads of the beams"] = field(
        default_factory=dict
    )
    gravity: Annotated[
        AccelerationVector | None, 'acceleration of free fall, axes of the ground: [0, 0, "-1 g"]; none on a motion'
    ] = None
    controllers: Annotated[
        Mapping[str, Feedback], "controllers in the loop, whose efforts add to those of the joints and forces"
    ] = field(default_factory=dict)
    order: tuple[str, ...] = follows()
    points: tuple[str, ...] = follows()
    coordinates: tuple[str, ...] = follows()
    unknown_coordinates: tuple[str, ...] = follows()
    flexible: dict[str, Structure] = follows()
    holding: dict[str, str] = follows()
    prescribed: list[Prescribed] = follows()
    tree: Tree = follows()
    courses: dict[str, Course] = follows()

    def __post_init__(self) -> None:
        """Check names, signals and drives, and derive the order of the bodies, the coordinates and the equations."""
        if not self.bodies:
            raise InputError("bodies", "is empty", "give one body or more")
        for where in ("bodies", "joints", "forces", "controllers"):
            for name in getattr(self, where):
                if not name.isidentifier() or name == GROUND:
                    raise InputError(f"{where}.{name}", "is no name", "give letters, digits and underscores")
        if self.gravity is not None:
            vector("gravity", self.gravity)
        assign(self, holding={joint.body: name for name, joint in self.joints.items()})
        assign(self, flexible={name: body for name, body in self.bodies.items() if isinstance(body, Structure)})
        assign(self, order=self._ordered())
        assign(self, points=tuple(f"{body}.{point}" for body in self.order for point in self.points_of(body)))
        assign(self, coordinates=self._named(), prescribed=self._prescribed())
        assign(self, tree=self._assembled())
        assign(self, unknown_coordinates=tuple(self.coordinates[k] for k in self.tree.unknowns))
        spun = [name for name, numbers, _ in self.prescribed if len(numbers) > 1]
        assign(self, courses={name: self.joints[name].course for name in spun})
        drives, signals = drives_of(self), measurable(self)
        for name, controller in self.controllers.items():
            for signal in controller.measure:
                choice(f"controllers.{name}.measure", signal, signals)
            for drive in controller.drive:
                choice(f"controllers.{name}.drive", drive, drives)
                if any(drive == f"{joint}.{rate}" for joint, _, rates in self.prescribed for rate in rates):
                    fix = "leave out the rate: what is prescribed is not controlled"
                    raise InputError(f"controllers.{name}.drive", f"is {drive!r}, whose rate is prescribed", fix)

    def __repr__(self) -> str:
        names = ", ".join(self.order)
        return f"System({names}; {len(self.tree.unknowns)} unknown coordinates)"

    @classmethod
    @typed
    def of(cls, body: RigidBody | Structure, name: str = "body") -> System:
        """A system of one body, which the ground holds by its root.

        Parameters
        ----------
        body : RigidBody or Structure
        name : str
            Of the body.

        Examples
        --------
        >>> strip = gb.Section.rectangle(width=0.02, thickness=0.004)
        >>> beam = gb.Beam(0.3, strip, gb.Material(2700, 70e9), damping_ratio=0.01)
        >>> gb.System.of(gb.assemble(beam, "FOAM", axial=1, y=2, z=2), "strip")
        System(strip; 5 unknown coordinates)
        """
        return cls({name: body}, {CLAMP: Joint("fixed", name)})

    def _ordered(self) -> tuple[str, ...]:
        """Names of the bodies, each after the one that holds it. InputError if none or two hold one, and for loops."""
        for name, joint in self.joints.items():
            if joint.body not in self.bodies:
                fix = f"choose from {', '.join(self.bodies)}"
                raise InputError(f"joints.{name}.body", f"is {joint.body!r}, and there is no such body", fix)
        for body in self.bodies:
            holding = [name for name, joint in self.joints.items() if joint.body == body]
            if not holding:
                fix = 'give a joint of this body: kind = "free" where nothing holds it'
                raise InputError(f"bodies.{body}", "hangs on nothing", fix)
            if len(holding) > 1:
                fix = f"keep one of {', '.join(holding)}: loops of joints are not computed"
                raise InputError(f"joints.{holding[1]}.body", f"is {body!r}, which {holding[0]} holds already", fix)
        order: list[str] = []
        remaining = [self.holding[body] for body in self.bodies]
        while remaining:
            ready = [name for name in remaining if self._parent(name) in (GROUND, *order)]
            if not ready:
                fix = "hang one of these bodies on the ground or on another body"
                raise InputError(f"joints.{remaining[0]}.on", f"makes a loop of {', '.join(remaining)}", fix)
            order += [self.joints[name].body for name in ready]
            remaining = [name for name in remaining if name not in ready]
        return tuple(order)

    def _parent(self, joint: str) -> str:
        """Name of the body that a joint hangs on."""
        parent_point = self.joints[joint].on
        if parent_point == GROUND:
            return GROUND
        self.point(f"joints.{joint}.on", parent_point)
        return parent_point.partition(".")[0]

    def points_of(self, body: str) -> tuple[str, ...]:
        """Return the names of a body's points, its root last.

        Parameters
        ----------
        body : str
            Its name.
        """
        terms = self.bodies[body]
        if isinstance(terms, RigidBody):
            return (*terms.points, ROOT)
        return (*stations_of(terms), ROOT)

    def point(self, where: str, name: str) -> tuple[str, int]:
        """Return the body and the index of a point.

        Parameters
        ----------
        where : str
            The argument that names it, for the error.
        name : str
            ``body.point``.

        Raises
        ------
        InputError
            If there is no such point.
        """
        body, _, point = name.partition(".")
        exists = body in self.bodies
        names = self.points_of(body) if exists else ()
        if point not in names:
            problem = f"{body} has no such point" if exists else f"there is no body {body!r}"
            bodies = [body] if exists else list(self.bodies)
            points = [f"{owner}.{label}" for owner in bodies for label in self.points_of(owner)]
            raise InputError(where, f"is {name!r}, and {problem}", advise(name, points))
        return body, names.index(point)

    @property
    def holds_jax(self) -> bool:
        """True if some of its values live in JAX, or are traced by it."""
        driven = [(joint.rates, joint.efforts) for joint in self.joints.values()]
        histories = [force.history for force in self.forces.values()]
        loads = [body.history for body in self.flexible.values()]
        controlled = any(controller.traced for controller in self.controllers.values())
        return controlled or holds_jax(self.tree, self.start, self.gravity, driven, histories, loads)

    @property
    def kind(self) -> str:
        """Word "system" in the place of a model's kind."""
        return "system"

    @property
    def only_structure(self) -> Structure | None:
        """The only body, where it is a structure that the ground holds by its root as it is, and nothing else acts."""
        acting = self.forces or self.controllers or self.gravity is not None
        if len(self.bodies) > 1 or acting or self.tree.links[0].steps:
            return None
        return self.flexible.get(self.order[0])

    def require_damping(self, answer: str) -> None:
        """Raise InputError where a body has no damping ratio and an `answer` depends on it."""
        for name, body in self.flexible.items():
            table = "beam" if self.only_structure is body and name == "beam" else f"bodies.{name}"  # of a scenario
            with naming(f"{table}.damping_ratio"):
                body.require_damping(answer)

    @property
    def floating(self) -> tuple[str, ...]:
        """Names of the bodies that no joint but free ones connects to the ground."""
        names = list[str]()
        for body in self.order:
            joint = self.joints[self.holding[body]]
            if joint.floats or joint.on.partition(".")[0] in names:
                names.append(body)
        return tuple(names)

    @property
    def warnings(self) -> tuple[str, ...]:
        """Doubts about the bodies' models, each behind the body's name."""
        bodies = self.bodies.items()
        return tuple(f"{name}: {warning}" for name, body in bodies for warning in getattr(body, "warnings", ()))

    @property
    def laden(self) -> set[str]:
        """Names of the bodies on whose points others hang or forces act."""
        hung = {self.order[link.parent] for link in self.tree.links if link.parent >= 0}
        return hung | {self.order[force.body] for force in self.tree.forces}

    @property
    def rubbing(self) -> tuple[str, ...]:
        """Names of the coordinates with friction and no prescribed rate, ``joint.angle``; of balls ``joint.rx``."""
        return tuple(
            f"{name}.{joint.values[joint.rate_names.index(kind)]}"
            for name, joint in self.joints.items()
            for kind in joint.frictions
            if kind not in joint.rates
        )

    def _named(self) -> tuple[str, ...]:
        """Names of all coordinates: those of the joints, and numbers for those of the flexible bodies."""
        names: list[str] = []
        for body in self.order:
            joint = self.holding[body]
            names += [f"{joint}.{coordinate}" for coordinate in self.joints[joint].coordinates]
            names += [f"{body}.q{k + 1}" for k in range(self._size(body))]
        return tuple(names)

    def _assembled(self) -> Tree:
        """Build the equations: links, forces and the indices of the prescribed coordinates."""
        index = {body: k for k, body in enumerate(self.order)}
        links, free = [], set[str]()  # bodies whose root moves by unknown coordinates
        for body in self.order:
            name = self.holding[body]
            joint = self.joints[name]
            parent, parent_point = -1, 0
            if joint.on != GROUND:
                holding, parent_point = self.point(f"joints.{name}.on", joint.on)
                parent = index[holding]
                deforms = holding in self.flexible and self.points_of(holding)[parent_point] != ROOT
                if deforms:
                    refuse_turnless(f"joints.{name}.on", self.flexible[holding], parent_point)
                if holding in free or deforms:
                    free.add(body)
            if len(joint.rates) < len(joint.rate_names):
                free.add(body)
            first = self.joints[self.holding[self.order[0]]]
            hinged = parent == 0 and joint.kind == "fixed" and first.kind == "revolute"
            terms = body_of(f"bodies.{body}", self.bodies[body], free=body in free, hinged=hinged)
            links.append(Link(joint.steps, joint.holder, terms, parent, parent_point, joint.loose))
        forces = []
        for name, force in self.forces.items():
            body, parent_point = self.point(f"forces.{name}.on", force.on)
            forces.append(Force(index[body], parent_point, force.follower))
        fixed = [self._first_coordinate(name) + k for name, numbers, _ in self.prescribed for k in numbers]
        return Tree(tuple(links), tuple(forces), tuple(fixed))

    def _first_coordinate(self, joint: str) -> int:
        """Index of a joint's first coordinate among all, or where it would be if the joint has none."""
        earlier_bodies = self.order[: self.order.index(self.joints[joint].body)]
        sizes = (len(self.joints[self.holding[body]].coordinates) + self._size(body) for body in earlier_bodies)
        return sum(sizes)

    def _size(self, body: str) -> int:
        """Number of coordinates that deform a body."""
        flexible = self.bodies[body]
        return 0 if isinstance(flexible, RigidBody) else flexible.size

    def row(self, name: str) -> int:
        """Return the index of the equation on which an effort on a joint acts.

        Parameters
        ----------
        name : str
            Of the rate along which it acts: ``joint.angle``, or ``joint.wx``.
        """
        joint, _, rate = name.rpartition(".")
        return self._first_coordinate(joint) + self.joints[joint].row(rate)

    def _prescribed(self) -> list[Prescribed]:
        """Groups of coordinates that are prescribed together: joint, their indices in it, and their rates' names."""
        groups = []
        for name, joint in self.joints.items():
            rates_by_numbers = dict[tuple[int, ...], list[str]]()
            for rate in joint.rates:
                rates_by_numbers.setdefault(joint.numbers(rate), []).append(rate)
            groups += [(name, numbers, tuple(rates)) for numbers, rates in rates_by_numbers.items()]
        return groups

    @property
    def start(self) -> tuple[Array, Array]:
        """All coordinates and their rates at the start, with flexible bodies undeformed."""
        q, qd = [], []
        for body in self.order:
            joint, zeros = self.joints[self.holding[body]], np.zeros(self._size(body))
            q += [joint.start, zeros]
            qd += [joint.start_rate, zeros]
        xp = namespace(*q, *qd)
        return xp.concatenate(q), xp.concatenate(qd)

    @property
    def start_state(self) -> State:
        """Frames of the bodies on a ground at rest, with the joints at the start and bodies undeformed."""
        q, zero, zeros = self.start[0], np.zeros(3), np.zeros(self.tree.size)
        return State(self.tree, q, zeros, zeros, Frame(np.eye(3), zero, zero, zero, zero, zero))

    @property
    def undeformed(self) -> Floats:
        """Places of all points, (points, 3) m, with the joints at the start and bodies undeformed."""
        return np.asarray(self.start_state.places)

    def corners(self, step: Seconds) -> Floats:
        """Return the times that steps should not pass unseen, s.

        Parameters
        ----------
        step : float
            Length of the steps, s.
        """
        times = [np.zeros(0)]
        for joint in self.joints.values():
            times += [profile.corners(step) for profile in (*joint.rates.values(), *joint.efforts.values())]
        times += [profile.corners(step) for force in self.forces.values() for profile in force.history]
        loads = [body.history for body in self.flexible.values() if body.history is not None]
        times += [history.corners(step) for history in loads]
        return np.concatenate(times)

    def inputs(self, t: Times, motion: Motion | None = None) -> Inputs:
        """Return what drives the tree.

        Parameters
        ----------
        t : array
            Times, s, of any shape.
        motion : Motion, optional
            Of the ground, which rests without one.
        """
        xp, shape = namespace(t), np.shape(t)
        zero, eye = xp.zeros((*shape, 3)), xp.broadcast_to(np.eye(3), (*shape, 3, 3))
        if motion is None:
            gravity = xp.zeros(3) if self.gravity is None else as_array(self.gravity)
            ground = Frame(eye, zero, zero, zero, zero - gravity, zero)
        else:
            base = motion.base(t)
            ground = Frame(eye, zero, zero, base.w_WB_B, base.a_WO_B, base.alpha_WB_B)
        prescribed, efforts = [], None
        for name, numbers, rates in self.prescribed:
            joint = self.joints[name]
            if len(numbers) > 1:
                parts = self.courses[name](t)
            else:
                rate, change = joint.rates[rates[0]].derivatives(t)
                turned = Hub(radius=0.0, rate=joint.rates[rates[0]]).angle(t)
                parts = tuple(values[..., None] for values in (joint.start[numbers[0]] + turned, rate, change))
            prescribed.append(namespace(*parts).stack(parts, axis=-2))
        columns = {}
        for name, joint in self.joints.items():
            for rate_name, profile in joint.efforts.items():
                columns[self.row(f"{name}.{rate_name}")] = profile(t)
        if columns:
            zeros = xp.zeros(shape)
            rows = [columns.get(k, zeros) for k in range(self.tree.size)]
            efforts = namespace(*columns.values()).stack(rows, axis=-1)
        wrenches = [concatenated([profile(t) for profile in force.history]) for force in self.forces.values()]
        loads = tuple(
            None if isinstance(body, RigidBody) or body.history is None else body.history(t)
            for body in (self.bodies[name] for name in self.order)
        )
        return Inputs(
            ground,
            concatenated(prescribed) if prescribed else None,
            efforts,
            loads,
            namespace(*wrenches).stack(wrenches, axis=-2) if wrenches else None,
        )

"""Systems: bodies by name, the joints that hold them, gravity, and forces at points."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated

import numpy as np

from gbeam.arrays.namespace import Array, as_array, concatenated, holds_jax, namespace
from gbeam.arrays.tree import Value, assign, follows
from gbeam.arrays.types import Floats
from gbeam.errors import InputError, naming
from gbeam.guards.arguments import typed
from gbeam.guards.checks import choice, vector
from gbeam.guards.quantities import AccelerationVector, Seconds, Times
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.tree.body_terms import body_of, refuse_turnless, stations_of
from gbeam.mechanics.tree.control import Feedback
from gbeam.mechanics.tree.course import Course
from gbeam.mechanics.tree.equations import Force, Inputs, State, Tree
from gbeam.mechanics.tree.frames import Frame
from gbeam.mechanics.tree.joints import GROUND, Joint
from gbeam.mechanics.tree.links import Link
from gbeam.mechanics.tree.loops import Ends, closed_start, looped, moved_in_words, turned_joint
from gbeam.mechanics.tree.point_force import PointForce
from gbeam.mechanics.tree.rigid_body import ROOT, RigidBody
from gbeam.mechanics.tree.signals import drives_of, measurable
from gbeam.motion.hub import Hub
from gbeam.motion.protocol import Motion
from gbeam.printable import advise

CLAMP = "clamp"  # joint of a system of one body
Prescribed = tuple[str, tuple[int, ...], tuple[str, ...]]


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
    closing : tuple of str
        Names of the joints that close loops.
    linked : tuple of str
        Names of all joints in the order of the tree's links: those that hold bodies, then those that close loops.
    prescribed : list of (str, tuple of int, tuple of str)
        Coordinates that are prescribed together, one, or a ball's four: name of the joint, indices among its
        coordinates, and names of the rates.
    tree : Tree
        The equations.
    courses : dict of str to Course
        Attitude over time of each ball whose spin is prescribed, by the joint's name.
    start : (array, array)
        All coordinates and their rates at the start, with loops closed and flexible bodies undeformed.

    Raises
    ------
    InputError
        If a body hangs on nothing, on two joints, or on a point that is not there, a loop cannot be closed, or an
        SFOAM's root moves by unknowns.

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
    joints: Annotated[
        Mapping[str, Joint], "one for every body, which holds it by its root, and more of points, which close loops"
    ]
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
    closing: tuple[str, ...] = follows()
    linked: tuple[str, ...] = follows()
    prescribed: list[Prescribed] = follows()
    tree: Tree = follows()
    courses: dict[str, Course] = follows()
    start: tuple[Array, Array] = follows()

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
        assign(self, closing=tuple(name for name, joint in self.joints.items() if "." in joint.body))
        held_by = {joint.body: name for name, joint in self.joints.items() if name not in self.closing}
        assign(self, holding=held_by)
        assign(self, flexible={name: body for name, body in self.bodies.items() if isinstance(body, Structure)})
        assign(self, order=self._ordered())
        assign(self, points=tuple(f"{body}.{point}" for body in self.order for point in self.points_of(body)))
        assign(self, linked=(*(self.holding[body] for body in self.order), *self.closing))
        assign(self, coordinates=self._named(), prescribed=self._prescribed())
        assign(self, tree=self._assembled(), start=self.given_start())
        if self.closing:
            self._close()
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
            if name not in self.closing and joint.body not in self.bodies:
                fix = f"choose from {', '.join(self.bodies)}"
                raise InputError(f"joints.{name}.body", f"is {joint.body!r}, and there is no such body", fix)
        for body in self.bodies:
            holding = [name for name, joint in self.joints.items() if joint.body == body]
            if not holding:
                fix = 'give a joint of this body: kind = "free" where nothing holds it'
                raise InputError(f"bodies.{body}", "hangs on nothing", fix)
            if len(holding) > 1:
                fix = f'name a point, such as "{body}.{ROOT}": a joint of a point that is held closes a loop'
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
        joined = [(joint.body.partition(".")[0], joint.on.partition(".")[0]) for joint in self.joints.values()]
        holds = [not joint.floats for joint in self.joints.values()]
        reached, count = {GROUND}, 0
        while len(reached) > count:
            count = len(reached)
            for ends, is_held in zip(joined, holds, strict=True):
                if is_held and reached.intersection(ends):
                    reached.update(ends)
        return tuple(body for body in self.order if body not in reached)

    @property
    def warnings(self) -> tuple[str, ...]:
        """Doubts about the bodies' models, each behind the body's name."""
        bodies = self.bodies.items()
        doubts = tuple(f"{name}: {warning}" for name, body in bodies for warning in getattr(body, "warnings", ()))
        return doubts + moved_in_words(self.closing, self.linked_joints, self.tree, self.start)

    @property
    def laden(self) -> set[str]:
        """Names of the bodies on whose points others hang or forces act."""
        hung = {self.order[link.parent] for link in self.tree.links if link.parent >= 0}
        closed_on = (closure.body for closure in self.tree.closures)
        return hung | {self.order[body] for body in (*(force.body for force in self.tree.forces), *closed_on)}

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
        for joint in self.linked:
            names += [f"{joint}.{coordinate}" for coordinate in self.joints[joint].coordinates]
            body = self.joints[joint].body
            names += [f"{body}.q{k + 1}" for k in range(self._size(body))]
        return tuple(names)

    def parent_of(self, joint: str) -> tuple[int, int]:
        """Return the indices of the body, −1 for the ground, and of its point, that a joint hangs on.

        Parameters
        ----------
        joint : str
            Its name.
        """
        if self.joints[joint].on == GROUND:
            return -1, 0
        holding, point = self.point(f"joints.{joint}.on", self.joints[joint].on)
        if holding in self.flexible and self.points_of(holding)[point] != ROOT:
            refuse_turnless(f"joints.{joint}.on", self.flexible[holding], point)
        return self.order.index(holding), point

    def _close(self) -> None:
        """Turn the joints that close loops, add them to the tree, and close it at the start."""
        if self.holds_jax:
            problem = "closes a loop, and neither gradients nor compiled batches of loops are computed"
            raise InputError(f"joints.{self.closing[0]}", problem, "ask for one run at a time")
        ends = [Ends(self.parent_of(name), self._end_of(name)) for name in self.closing]
        state, joints = self.start_state, dict(self.joints)
        for name, pair in zip(self.closing, ends, strict=True):
            joints[name] = turned_joint(joints[name], pair, state)
        tree = looped(self.tree, [joints[name] for name in self.closing], ends)
        assign(self, joints=joints, tree=tree, start=self.given_start())
        size = float(np.ptp(self.undeformed, axis=0).max()) or 1.0
        tree, start = closed_start(tree, self.linked_joints, self.start, self.inputs(np.zeros(())), size)
        assign(self, tree=tree, start=start)

    def _end_of(self, joint: str) -> tuple[int, int]:
        """Indices of the body and of the point that a joint closes a loop on."""
        where = f"joints.{joint}.body"
        body, point = self.point(where, self.joints[joint].body)
        if body in self.flexible and self.points_of(body)[point] != ROOT:
            refuse_turnless(where, self.flexible[body], point)
        return self.order.index(body), point

    def _assembled(self) -> Tree:
        """Build the equations of the tree: links, forces and the indices of the prescribed coordinates."""
        index = {body: k for k, body in enumerate(self.order)}
        links, free = [], set[str]()  # bodies whose root moves by unknown coordinates
        for body in self.order:
            name = self.holding[body]
            joint = self.joints[name]
            parent, parent_point = self.parent_of(name)
            if parent >= 0:
                holding = self.order[parent]
                deforms = holding in self.flexible and self.points_of(holding)[parent_point] != ROOT
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
        earlier = self.linked[: self.linked.index(joint)]
        return sum(len(self.joints[name].coordinates) + self._size(self.joints[name].body) for name in earlier)

    @property
    def linked_joints(self) -> dict[str, Joint]:
        """Joints by name, in the order of the tree's links."""
        return {name: self.joints[name] for name in self.linked}

    def link(self, joint: str) -> int:
        """Return the index of the link of a joint in the tree.

        Parameters
        ----------
        joint : str
            Its name.
        """
        return self.linked.index(joint)

    def _size(self, body: str) -> int:
        """Number of coordinates that deform a body."""
        return self.flexible[body].size if body in self.flexible else 0

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

    def given_start(self) -> tuple[Array, Array]:
        """All coordinates and their rates as joints have them at the start, with flexible bodies undeformed."""
        q, qd = [], []
        for name in self.linked:
            joint, zeros = self.joints[name], np.zeros(self._size(self.joints[name].body))
            q += [joint.start, zeros]
            qd += [joint.start_rate, zeros]
        xp = namespace(*q, *qd)
        return xp.concatenate(q), xp.concatenate(qd)

    @property
    def start_state(self) -> State:
        """Frames of the bodies on a ground at rest, with the joints at the start and bodies undeformed."""
        q, zero, zeros = self.start[0][: self.tree.size], np.zeros(3), np.zeros(self.tree.size)
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
        loads += (None,) * len(self.closing)
        return Inputs(
            ground,
            concatenated(prescribed) if prescribed else None,
            efforts,
            loads,
            namespace(*wrenches).stack(wrenches, axis=-2) if wrenches else None,
        )

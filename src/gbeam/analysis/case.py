"""Cases: one beam in one model, another specimen, or a system of bodies, the environments it is put into, and how its
response is computed.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import InitVar, dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar, overload

import numpy as np
from numpy.typing import ArrayLike

from gbeam.analysis.response.settings import ResponseSettings
from gbeam.arrays.tree import Value
from gbeam.arrays.types import Numbers
from gbeam.errors import InputError, naming
from gbeam.guards.arguments import typed
from gbeam.guards.kinds import kinds
from gbeam.mechanics.assembly import assemble
from gbeam.mechanics.fields.basis import FAMILIES, quadrature
from gbeam.mechanics.models import Model
from gbeam.mechanics.plausibility import input_warnings
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.tree.joints import GROUND, Joint
from gbeam.mechanics.tree.system import RigidBody, System
from gbeam.motion import Flight
from gbeam.motion.protocol import Motion, notes_on
from gbeam.results.criteria import (
    AT_POINTS,
    DISPLACEMENT,
    KINDS_OF_LIMITS,
    STRESS,
    Acceptance,
    refuse_lacking,
    refuse_unknown,
)
from gbeam.results.description import (
    BodyOfSystem,
    ControllerOfSystem,
    Description,
    ForceOfSystem,
    JointOfSystem,
    SpecimenDescription,
    SystemDescription,
)
from gbeam.results.provenance import Provenance
from gbeam.structure.beam import Beam

if TYPE_CHECKING:
    from gbeam.results.response import Sensor
    from gbeam.scenario.load import AnyScenario
    from gbeam.scenario.schema.scenario import Scenario
    from gbeam.scenario.schema.system import SpecimenScenario, SystemScenario


class _InEnvironments(Value):
    """A beam, another specimen or a system that is put into environments."""

    title: str
    motions: Mapping[str, Motion]
    response: ResponseSettings | None
    accept: Mapping[str, Acceptance]
    no_beam: ClassVar[tuple[str, str]] = ("", "")  # problem and fix of the error of `one_beam`

    def __post_init__(self, read_from: AnyScenario | None) -> None:
        if read_from is not None and not hasattr(type(read_from), "model_fields"):  # pydantic's, not imported for it
            fix = "leave it out: read_scenario gives it"
            raise InputError("read_from", f"is of type {type(read_from).__name__}", fix)
        for name, limits in self.accept.items():
            refuse_unknown(f"motion.{name}.accept", limits)
        # By another name than the field's, so that dataclasses.replace leaves it behind.
        object.__setattr__(self, "scenario", read_from)

    def __repr__(self) -> str:
        motions = ", ".join(f"{name}: {motion.kind}" if motion else name for name, motion in self.environments.items())
        subject = self.model.kind if isinstance(self, Case) else repr(self.assemble())  # type: ignore[attr-defined]
        duration = "" if self.response is None else f", {self.response.duration:g} s"
        return f"{type(self).__name__}({self.title!r}, {subject}, {{{motions}}}{duration})"

    @property
    def automatic(self) -> bool:
        """True if the numbers of shapes are chosen by the errors."""
        return False

    @property
    def environments(self) -> Mapping[str, Motion | None]:
        """Motions of the base, by name; the ground at rest where there is none."""
        return self.motions or {GROUND: None}

    @property
    def start(self) -> float:
        """Time at which motions are frozen unless another is asked for, s."""
        return 0.0 if self.response is None else self.response.start

    @property
    def over_time(self) -> ResponseSettings:
        """Settings of the response; InputError where no duration is given, or nothing moves one structure's base."""
        self.require_motion()
        if self.response is None:
            raise InputError("response", "duration is missing", 'no record gives one: add duration = "16 s"')
        return self.response

    @property
    def extent(self) -> dict[str, Any]:
        """Argument of :func:`gbeam.plan` that says where the specimen is."""
        return extent_of(self.beam if isinstance(self, Case) else self.assemble())  # type: ignore[attr-defined]

    def require_motion(self) -> None:
        """Raise InputError where nothing moves the base of one structure."""
        if not self.motions and not isinstance(self, SystemCase):
            fix = 'add what the base does, each [motion.NAME], such as kind = "flight"; `gbeam new` shows how'
            raise InputError("motion", "is missing", fix)

    def _stress_limits(self, lacking: Mapping[str, str]) -> Iterator[tuple[str, str]]:
        """Yield place in the scenario and point of every limit on stress; InputError for limits on what is lacking."""
        for name, limits in self.accept.items():
            where = f"motion.{name}.accept"
            refuse_lacking(where, limits, lacking)
            yield from ((f"{where}.{key}", limits[key]) for key in AT_POINTS if limits.get(key) is not None)

    def one_beam(self, where: str, what: str) -> Case:
        """Return the case if it is of one beam; else raise InputError at `where`: the answer `what` needs a beam."""
        problem, fix = self.no_beam
        raise InputError(where, f"{problem}, and {what} is of one beam", fix)


@kinds(accept={"*": KINDS_OF_LIMITS})
@typed
@dataclass(frozen=True, eq=False, repr=False)
class Case(_InEnvironments):
    """Objects that a scenario describes.

    Parameters
    ----------
    title : str
    beam : Beam
    model : Model
    motions : mapping of str to motion
        By name, in the scenario's order; the base rests without any.
    response : ResponseSettings or None
        None where nothing is computed over time.
    tracks : mapping of str to str
        Name of the flight that each centrifuge tracks.
    stations : tuple of float
        Positions of output from the root besides the tip, m.
    accept : mapping of str to mapping
        By the centrifuge's name, the limits that decide whether it is accepted, and ``tolerance`` and ``tolerance_of``:
        see :func:`gbeam.compare`.
    provenance : Provenance, optional
        Of the scenario; results of the whole case have it.
    sensors : mapping of str to Sensor
        Accelerometers by the names of points, whose readings results have.
    read_from : Scenario, optional
        The scenario that these are the objects of.

    Attributes
    ----------
    scenario : Scenario or None
        What it was read from; None of a case that is made, or changed, in Python.

    Examples
    --------
    >>> case = gb.read_scenario("examples/f16_8g_turn.toml")
    >>> list(case.motions)
    ['flight', 'centrifuge']
    >>> case.tracks["centrifuge"]
    'flight'
    """

    title: str
    beam: Beam
    model: Model
    motions: Mapping[str, Motion]
    response: ResponseSettings | None
    tracks: Mapping[str, str] = field(default_factory=dict)
    stations: Numbers = ()
    accept: Mapping[str, Acceptance] = field(default_factory=dict)
    provenance: Provenance | None = None
    sensors: Mapping[str, Sensor] = field(default_factory=dict)
    read_from: InitVar[Scenario | None] = None
    scenario: Scenario | None = field(default=None, init=False, repr=False, compare=False)

    def assemble(self, stations: ArrayLike | None = None) -> Structure:
        """Put the beam into its model.

        Parameters
        ----------
        stations : (s,), optional
            Positions of output from the root besides the tip, m; by default the case's own.

        Raises
        ------
        InputError
            If the beam does not fit its model, with its place in the scenario.
        """
        try:
            return assemble(self.beam, self.model, self.stations if stations is None else stations)
        except InputError as error:
            raise error.within("response" if error.where.startswith("stations") else "beam") from None

    @property
    def automatic(self) -> bool:
        return self.model.automatic

    def one_beam(self, where: str, what: str) -> Case:
        return self


@kinds(accept={"*": KINDS_OF_LIMITS})
@typed
@dataclass(frozen=True, eq=False, repr=False)
class SystemCase(_InEnvironments):
    """Objects that a scenario of a system of bodies describes.

    Parameters
    ----------
    title : str
    system : System
    motions : mapping of str to motion
        Of the ground, by name; without any it rests.
    response : ResponseSettings or None
        None where nothing is computed over time.
    tracks : mapping of str to str
        Name of the flight that each centrifuge tracks.
    accept : mapping of str to mapping
        As of a :class:`Case`, and ``point``, whose displacement is compared.
    provenance : Provenance, optional
        Of the scenario; results of the whole case have it.
    sensors : mapping of str to Sensor
        Accelerometers by the names of points, whose readings results have.
    read_from : SystemScenario, optional
        The scenario that these are the objects of.

    Attributes
    ----------
    scenario : SystemScenario or None
        What it was read from; None of a case that is made, or changed, in Python.

    Raises
    ------
    InputError
        If gravity is given beside a motion, which carries its own, a motion is a hub that turns freely, or a point of
        `accept` is not there.

    Examples
    --------
    >>> case = gb.read_scenario("examples/satellite_two_panels.toml")
    >>> case.system.order
    ('bus', 'right', 'left')
    """

    title: str
    system: System
    motions: Mapping[str, Motion]
    response: ResponseSettings | None
    tracks: Mapping[str, str] = field(default_factory=dict)
    accept: Mapping[str, Acceptance] = field(default_factory=dict)
    provenance: Provenance | None = None
    sensors: Mapping[str, Sensor] = field(default_factory=dict)
    read_from: InitVar[SystemScenario | None] = None
    scenario: SystemScenario | None = field(default=None, init=False, repr=False, compare=False)
    no_beam = (
        "make a system",
        "ask for run, static, modes, campbell, critical-speed or linearize, or sweep these; or give one [beam]",
    )

    def __post_init__(self, read_from: AnyScenario | None) -> None:
        super().__post_init__(read_from)
        for name, motion in self.motions.items():
            if motion.free:
                fix = "give it as a body on a revolute joint"
                raise InputError(f"motion.{name}", "is a hub that turns freely, and carries a system", fix)
            if self.system.gravity is not None:
                fix = f"leave one out: {name} carries its own, as specific force"
                raise InputError("system.gravity", "is given beside a motion of the ground", fix)
        for point in self.sensors:
            self.system.point(f"sensors.{point}", point)
        for name, limits in self.accept.items():
            if limits.get("point") is not None:
                self.system.point(f"motion.{name}.accept.point", limits["point"])
            for point in limits.get("control", ()):
                self.system.point(f"motion.{name}.accept.control.{point}", point)
        flexible = self.system.flexible.items()
        stressed = [key for key, body in flexible if body.sections is not None or body.recovery is not None]
        for where, point in self._stress_limits({} if stressed else {STRESS: "no body is a beam or a mesh"}):
            body, _ = self.system.point(where, point)
            if body not in stressed:
                fix = f"choose a point of {', '.join(stressed)}"
                raise InputError(where, f"is on {body}, which is no beam and no mesh", fix)

    def assemble(self, stations: ArrayLike | None = None) -> System:
        """Return the system; it has no stations.

        Parameters
        ----------
        stations : ignored
            Of beams.
        """
        return self.system


@kinds(accept={"*": KINDS_OF_LIMITS})
@typed
@dataclass(frozen=True, eq=False, repr=False)
class SpecimenCase(_InEnvironments):
    """Objects that a scenario of one specimen that is no beam describes: a solid, matrices, or a rigid box.

    Parameters
    ----------
    title : str
    name : str
        Of the specimen.
    structure : Structure
    motions : mapping of str to motion
        By name, in the scenario's order; the base rests without any.
    response : ResponseSettings or None
        None where nothing is computed over time.
    tracks : mapping of str to str
        Name of the flight that each centrifuge tracks.
    accept : mapping of str to mapping
        As of a :class:`Case`.
    provenance : Provenance, optional
        Of the scenario; results of the whole case have it.
    sensors : mapping of str to Sensor
        Accelerometers by the names of points, whose readings results have.
    read_from : SpecimenScenario, optional
        The scenario that these are the objects of.

    Attributes
    ----------
    scenario : SpecimenScenario or None
        What it was read from; None of a case that is made, or changed, in Python.

    Raises
    ------
    InputError
        If a motion is a hub that turns freely, and the specimen is rigid; or a limit is of what it does not have.

    Examples
    --------
    >>> case = gb.read_scenario("examples/bracket.toml")
    >>> case.name, case.structure
    ('bracket', Structure(solid, 19 coordinates, 0.251 kg))
    """

    title: str
    name: str
    structure: Structure
    motions: Mapping[str, Motion]
    response: ResponseSettings | None
    tracks: Mapping[str, str] = field(default_factory=dict)
    accept: Mapping[str, Acceptance] = field(default_factory=dict)
    provenance: Provenance | None = None
    sensors: Mapping[str, Sensor] = field(default_factory=dict)
    read_from: InitVar[SpecimenScenario | None] = None
    scenario: SpecimenScenario | None = field(default=None, init=False, repr=False, compare=False)
    no_beam = (
        "is no beam",
        "ask for run, static, modes, campbell, critical-speed, linearize, plan or fit, or sweep these; or give a beam",
    )

    def __post_init__(self, read_from: AnyScenario | None) -> None:
        super().__post_init__(read_from)
        for name, motion in self.motions.items():
            if motion.free and not self.structure.size:
                fix = "give the hub a rate: the motion of a rigid specimen follows from it alone"
                raise InputError(f"motion.{name}", "is a hub that turns freely, and carries a rigid specimen", fix)
        rigid, recovery = not self.structure.size, self.structure.recovery
        lacking = {STRESS: f"{self.name} is {'rigid' if rigid else 'no mesh'}"} if rigid or recovery is None else {}
        lacking |= {DISPLACEMENT: f"{self.name} is rigid"} if rigid else {}
        for where, point in self._stress_limits(lacking):
            with naming(where):
                if recovery is not None:
                    recovery.strain(point, (1.0, 0.0, 0.0))

    def assemble(self, stations: ArrayLike | None = None) -> Structure:
        """Return the structure, which needs no assembly; its output stations are its named points.

        Parameters
        ----------
        stations : ignored
            Accepted as the cases of beams do.
        """
        return self.structure

    def one_beam(self, where: str, what: str) -> Case:
        return super().one_beam(f"{where}.{self.name}", what)


AnyCase = Case | SpecimenCase | SystemCase


def extent_of(specimen: Beam | Structure | System) -> dict[str, Any]:
    """Argument of :func:`gbeam.plan` for the extent of an undeformed specimen; none for matrices, which have none."""
    if isinstance(specimen, Beam):
        return {"beam": specimen}
    if isinstance(specimen, System):
        return {"envelope": specimen.undeformed}
    return {} if specimen.recovery is None else {"envelope": specimen.recovery.envelope}


MODES = 6  # natural frequencies at most


@overload
def describe(case: Case) -> Description: ...
@overload
def describe(case: SpecimenCase) -> SpecimenDescription: ...
@overload
def describe(case: SystemCase) -> SystemDescription: ...
@typed
def describe(case: Case | SpecimenCase | SystemCase) -> Description | SpecimenDescription | SystemDescription:
    """Describe a case: the beam's mass, its frequencies at rest, or bodies and joints; motions, records, and settings.

    Parameters
    ----------
    case : Case, SpecimenCase or SystemCase
        From :func:`gbeam.read_scenario`, or made by hand.

    Returns
    -------
    Description, SpecimenDescription or SystemDescription

    Raises
    ------
    InputError
        If the beam does not fit its model, with its place in the scenario.

    Examples
    --------
    >>> case = gb.read_scenario("examples/f16_8g_turn.toml")
    >>> description = gb.describe(case)
    >>> print(f"{description.mass:.4f} kg, {description.duration} s, {description.counts}")
    0.0648 kg, 15.99 s, {'axial': 1, 'y': 3, 'z': 3}
    """
    if isinstance(case, SystemCase):
        system, doubts = case.system, [case.system.warnings]
        return SystemDescription(
            bodies={name: _body(system, name) for name in system.order},
            joints={name: _joint(joint) for name, joint in system.joints.items()},
            forces={name: ForceOfSystem(force.on, force.follower) for name, force in system.forces.items()},
            controllers={
                name: ControllerOfSystem(tuple(law.measure), tuple(law.drive), law.sample, law.delay)
                for name, law in system.controllers.items()
            },
            gravity=None if system.gravity is None else tuple(map(float, system.gravity)),  # type: ignore[arg-type]
            **_described(case, doubts),
        )
    structure, settings = case.assemble(), case.response
    span = case.start, case.start + (0.0 if settings is None else settings.duration)
    doubts = [input_warnings(structure, motion, name=name, span=span) for name, motion in case.motions.items()]
    doubts = doubts or [input_warnings(structure)]
    if isinstance(case, SpecimenCase):
        total, *moment = (float(value) for value in structure.coefficients.rigid[:4])
        return SpecimenDescription(
            name=case.name,
            kind=structure.kind,
            mass=total,
            centre=np.array(moment) / total,
            coordinates=structure.size,
            points=structure.points,
            clamps={} if structure.recovery is None else structure.recovery.clamps,
            frequency=np.asarray(structure.rest[0])[: min(MODES, structure.resolved)] / (2 * np.pi),
            **_described(case, doubts),
        )
    beam = case.beam
    frequencies, modes = structure.rest
    # A mode bends along the axis of the group of coordinates that moves most.
    groups = np.repeat(FAMILIES, structure.counts)
    rule = quadrature(beam.length, 4, beam.section.stations)
    return Description(
        length=beam.length,
        mass=beam.density * float(np.sum(beam.section.at(rule.node).area * rule.weight)),
        bodies=tuple((body.at, body.mass) for body in beam.masses),
        model=case.model.kind,
        counts={name: n for name, n in zip(FAMILIES, case.model.counts, strict=True) if n or name in FAMILIES[:3]},
        frequency=np.asarray(frequencies)[:MODES] / (2 * np.pi),
        direction=tuple(str(groups[i]) for i in np.abs(modes[: len(groups)]).argmax(axis=0)[:MODES]),
        **_described(case, doubts),
    )


def _described(case: AnyCase, doubts: Sequence[Sequence[str]]) -> dict[str, Any]:
    """Parts of a description that every case has."""
    settings, over_time = case.response, dict[str, Any]()
    if settings is not None:
        over_time = {key: getattr(settings, key) for key in ("start", "duration", "step", "integrator")}
        doubts = (*doubts, settings.warnings)
    return dict(
        title=case.title,
        motions={name: motion.kind for name, motion in case.motions.items()},
        tracks=dict(case.tracks),
        scales={
            name: motion.level_factor
            for name, motion in case.motions.items()
            if isinstance(motion, Flight) and motion.level_factor is not None
        },
        records={
            name: motion.record
            for name, motion in case.motions.items()
            if isinstance(motion, Flight) and motion.record is not None
        },
        **over_time,
        notes=notes_on(case.motions),
        warnings=tuple(dict.fromkeys(warning for warnings in doubts for warning in warnings)),
    )


def _body(system: System, name: str) -> BodyOfSystem:
    body, points = system.bodies[name], system.points_of(name)
    if isinstance(body, RigidBody):
        return BodyOfSystem("rigid", body.mass, 0, points, {})
    clamps = {} if body.recovery is None else body.recovery.clamps
    return BodyOfSystem(body.kind, float(body.mass.sum()), body.size, points, clamps)


def _joint(joint: Joint) -> JointOfSystem:
    driven, prescribed = tuple(joint.efforts), tuple(joint.rates)
    moving = (kind for kind in joint.rate_names if kind not in (*driven, *prescribed))
    return JointOfSystem(joint.kind, joint.body, joint.on, tuple(moving), driven, prescribed)

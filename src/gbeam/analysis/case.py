"""Cases: a system of bodies, the environments it is put into, and how its response is computed."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import InitVar, dataclass, field, replace
from typing import Annotated, Any

from gbeam.analysis.one_body import OneBody, points_of, refuse_no_point, structure_of
from gbeam.analysis.response.settings import ResponseSettings
from gbeam.arrays.tree import Value
from gbeam.arrays.types import Numbers
from gbeam.errors import InputError, naming
from gbeam.guards.arguments import typed
from gbeam.guards.kinds import kinds
from gbeam.guards.quantities import OfKind
from gbeam.mechanics.assembly import model_of
from gbeam.mechanics.models import Model
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.tree.joints import GROUND
from gbeam.mechanics.tree.system import System
from gbeam.motion.protocol import Motion
from gbeam.results.criteria import (
    AT_POINTS,
    DISPLACEMENT,
    KINDS_OF_LIMITS,
    STRESS,
    Acceptance,
    refuse_lacking,
    refuse_unknown,
)
from gbeam.results.provenance import Provenance, ScenarioText
from gbeam.results.sensors import Sensor
from gbeam.structure.beam import Beam


@kinds(accept={"*": KINDS_OF_LIMITS})
@typed
@dataclass(frozen=True, eq=False, repr=False)
class Case(OneBody, Value):
    """Objects that a scenario describes.

    Parameters
    ----------
    title : str
    system : System
        The bodies; of one on the base :meth:`System.of`, of one beam :meth:`of_beam`.
    motions : mapping of str to motion
        Of the base, by name, in the scenario's order; it rests without any.
    response : ResponseSettings or None
        None where nothing is computed over time.
    tracks : mapping of str to str
        Name of the flight that each centrifuge tracks.
    accept : mapping of str to mapping
        By the centrifuge's name, the limits that decide whether it is accepted, ``tolerance`` and ``tolerance_of``, and
        of several bodies ``point``, whose displacement is compared: see :func:`gbeam.compare`.
    provenance : Provenance, optional
        Of the scenario; results of the whole case have it.
    sensors : mapping of str to Sensor
        Accelerometers by the names of points, whose readings results have.
    read_from : ScenarioText, optional
        The text that these are the objects of.
    spans : mapping of str to (float, float)
        By the motion's name, first and last time of its response, s, where motions last differently: records of several
        manoeuvres. The others have those of `response`.

    Attributes
    ----------
    scenario : ScenarioText or None
        The text it was read from; None of a case that is made, or changed, in Python.
    beam, model, stations
        Of the only body, where it is a beam that the base holds.

    Raises
    ------
    InputError
        If gravity is given beside a motion, which carries its own, a hub that turns freely carries several bodies or a
        rigid one, a point of `sensors` or `accept` is not there, or a limit is of what the bodies do not have.

    Examples
    --------
    >>> case = gb.read_scenario("examples/f16_8g_turn.toml")
    >>> list(case.motions)
    ['flight', 'centrifuge']
    >>> case.tracks["centrifuge"]
    'flight'
    >>> gb.read_scenario("examples/satellite_two_panels.toml").system.order
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
    read_from: InitVar[ScenarioText | None] = None
    spans: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    scenario: ScenarioText | None = field(default=None, init=False, repr=False, compare=False)

    @classmethod
    @typed
    def of_beam(
        cls,
        title: str,
        beam: Beam,
        model: Model,
        motions: Mapping[str, Motion],
        response: ResponseSettings | None,
        tracks: Mapping[str, str] | None = None,
        *,
        stations: Annotated[Numbers, OfKind("length")] = (),
        accept: Mapping[str, Acceptance] | None = None,
        sensors: Mapping[str, Sensor] | None = None,
    ) -> Case:
        """Make the case of one beam, whose root the base holds.

        Parameters
        ----------
        title, motions, response, tracks, accept, sensors
            As of the class.
        beam : Beam
        model : Model
        stations : tuple of float
            Positions of output from the root besides the tip, m.

        Raises
        ------
        InputError
            If the beam does not fit its model, with its place in the scenario.

        Examples
        --------
        >>> strip = gb.Section.rectangle(width=0.02, thickness=0.004)
        >>> beam = gb.Beam(0.3, strip, gb.Material(2700, 70e9), damping_ratio=0.01)
        >>> turn = gb.Flight(z=gb.trapezoid(78.5, jerk=39.2, start=0.5, hold=1.0))
        >>> gb.Case.of_beam("A strip", beam, gb.Model("FOAM", 1, 2, 2), {"turn": turn}, gb.ResponseSettings(6.0))
        Case('A strip', FOAM, {turn: flight}, 6 s)
        """
        system = System.of(structure_of(beam, model, tuple(stations)), BEAM)
        return cls(title, system, motions, response, tracks or {}, accept or {}, sensors=sensors or {})

    def __post_init__(self, read_from: ScenarioText | None) -> None:
        if not isinstance(read_from, ScenarioText | None):
            fix = "leave it out: read_scenario gives it"
            raise InputError("read_from", f"is of type {type(read_from).__name__}", fix)
        for name, limits in self.accept.items():
            refuse_unknown(f"motion.{name}.accept", limits)
        for name, motion in self.motions.items():
            self._refuse_motion(f"motion.{name}", name, motion)
        for name, (start, end) in self.spans.items():
            if name not in self.motions:
                raise InputError(f"spans.{name}", "names no motion", f"choose of {', '.join(self.motions)}")
            if not end > start:
                raise InputError(f"spans.{name}", f"ends at {end:g} s and begins at {start:g} s", "let it end later")
        for error in refusals(self.system, self.accept, self.sensors):
            raise error
        # By another name than the field's, so that dataclasses.replace leaves it behind.
        object.__setattr__(self, "scenario", read_from)

    def __repr__(self) -> str:
        motions = ", ".join(f"{name}: {motion.kind}" if motion else name for name, motion in self.environments.items())
        subject = repr(self.subject) if self.only_beam is None else self.model.kind
        same_times = self.response is not None and not self.spans
        duration = f", {self.over_time.duration:g} s" if same_times else ""
        return f"{type(self).__name__}({self.title!r}, {subject}, {{{motions}}}{duration})"

    def _refuse_motion(self, where: str, name: str, motion: Motion) -> None:
        """Raise InputError for a motion of the base that the system cannot have."""
        body = self.system.only_structure
        if motion.free and body is None:
            fix = "give it as a body on a revolute joint"
            raise InputError(where, "is a hub that turns freely, and carries a system", fix)
        if motion.free and body is not None and not body.size:
            fix = "give the hub a rate: the motion of a rigid specimen follows from it alone"
            raise InputError(where, "is a hub that turns freely, and carries a rigid specimen", fix)
        if self.system.gravity is not None:
            fix = f"leave one out: {name} carries its own, as specific force"
            raise InputError("system.gravity", "is given beside a motion of the ground", fix)

    @property
    def points(self) -> tuple[str, ...]:
        """Names of the points that results have: ``tip`` of a body alone on the base, else ``body.point``."""
        return points_of(self.system)

    @property
    def automatic(self) -> bool:
        """True if a study chooses the numbers of shapes of a beam by the errors that they leave."""
        return bool(self.automatic_beams)

    @property
    def automatic_beams(self) -> Mapping[str, Structure]:
        """Bodies whose numbers of shapes a study chooses, by name."""
        beams = {name: body for name, body in self.system.flexible.items() if body.source is not None}
        return {name: body for name, body in beams.items() if model_of(body).automatic}

    def refuse_automatic(self, problem: str, fix: str) -> None:
        """Raise InputError, at the place of its numbers of shapes, where a beam leaves them to be chosen.

        Parameters
        ----------
        problem, fix : str
            Of the error.
        """
        for name in self.automatic_beams:
            raise InputError("model.modes" if name == BEAM else f"bodies.{name}.model.modes", problem, fix)

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
        """Settings of the response; InputError where no duration is given, or nothing moves what is on the base."""
        self.require_motion()
        if self.response is None:
            raise InputError("response", "duration is missing", 'no record gives one: add duration = "16 s"')
        return self.response

    def settings_of(self, name: str) -> ResponseSettings:
        """Settings of the response in the motion `name`, over its own time; errors as of :attr:`over_time`."""
        if name not in self.spans:
            return self.over_time
        start, end = self.spans[name]
        return replace(self.over_time, start=start, duration=end - start)

    def start_of(self, name: str) -> float:
        """Time at which the motion `name` is frozen unless another is asked for, s."""
        return self.spans[name][0] if name in self.spans else self.start

    def require_motion(self) -> None:
        """Raise InputError where a body is held by a base that nothing moves."""
        if not self.motions and self.system.only_structure is not None:
            fix = 'add what the base does, each [motion.NAME], such as kind = "flight"; `gbeam new` shows how'
            raise InputError("motion", "is missing", fix)


BEAM = "beam"  # name of the body of a case of one beam


def refusals(system: System, accept: Mapping[str, Acceptance], sensors: Mapping[str, Sensor]) -> Iterator[InputError]:
    """Yield an error for each point of a sensor or a limit that the system does not have, and for each limit on a
    quantity that it does not have.
    """
    for point in sensors:
        yield from _refused(refuse_no_point, system, f"sensors.{point}", point)
    lacking = _lacking(system)
    for name, limits in accept.items():
        where, settings = f"motion.{name}.accept", dict[str, Any](limits)
        yield from _refused(refuse_lacking, where, limits, lacking)
        for point in settings.get("control", ()):
            yield from _refused(refuse_no_point, system, f"{where}.control.{point}", point)
        for key in ("point", *AT_POINTS):
            refuse = refuse_no_point if key == "point" or STRESS in lacking else _refuse_unstressed
            if settings.get(key) is not None:
                yield from _refused(refuse, system, f"{where}.{key}", settings[key])


def _refused(ask: Callable[..., Any], *args: Any) -> list[InputError]:
    """Call a function that may refuse its arguments; return its InputError in a list, or an empty one."""
    try:
        ask(*args)
    except InputError as error:
        return [error]
    return []


def _lacking(system: System) -> dict[str, str]:
    """Quantities that no response of the system has, each with the reason in words."""
    rigid = not any(body.size for body in system.flexible.values())
    of_rigid = f"{', '.join(system.order)} {'are' if len(system.order) > 1 else 'is'} rigid"
    lacking = dict[str, str]()
    if not _stressed(system):
        lacking[STRESS] = of_rigid if rigid else "no body is a beam or a mesh"
    if not len(system.tree.unknowns):
        lacking[DISPLACEMENT] = of_rigid
    return lacking


def _stressed(system: System) -> list[str]:
    """Names of the bodies that have a stress: beams and meshes."""
    deforming = ((name, body) for name, body in system.flexible.items() if body.size)
    return [name for name, body in deforming if body.sections is not None or body.recovery is not None]


def _refuse_unstressed(system: System, where: str, point: str) -> None:
    """Raise InputError unless a point has a stress."""
    name, number = refuse_no_point(system, where, point)
    stressed = _stressed(system)
    if name not in stressed:
        problem = f"is on {name}, which is no beam and no mesh"
        raise InputError(where, problem, f"choose a point of {', '.join(stressed)}")
    recovery = system.flexible[name].recovery
    if recovery is not None:
        with naming(where):
            recovery.strain(system.points_of(name)[number], (1.0, 0.0, 0.0))

"""Protocol of motions of the base, and what is implausible about one."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, ClassVar, Protocol, Self, runtime_checkable

import numpy as np

from gbeam.arrays.namespace import holds_jax
from gbeam.arrays.types import Floats
from gbeam.guards.checks import implausible
from gbeam.motion.flight import Flight
from gbeam.motion.hub import Hub
from gbeam.results.parts import Base
from gbeam.results.result import each_once, part_words


@runtime_checkable
class Motion(Protocol):
    """A flight, a centrifuge or a hub.

    ``kind`` names which. Where ``free`` is true the motion is a result: a hub whose rate is not given. NumPy in, NumPy
    out. JAX arrays and tracers, in the times or in the motion's own values, pass through.
    """

    kind: ClassVar[str]

    @property
    def free(self) -> bool:
        """True if the base's motion is an unknown of the equations of motion."""
        ...

    def base(self, t: Any) -> Base:
        """Motion of the base at times `t` (s, any shape)."""
        ...

    def corners(self, step: float) -> Floats:
        """Times that steps of length `step` (s) should not pass unseen, s, ascending."""
        ...

    def over(self, start: float, end: float) -> Self:
        """Return the motion prepared for times from `start` to `end`, s."""
        ...

    def beyond(self, start: float, end: float) -> tuple[Any, Any]:
        """Return the times that a machine moves before `start` and after `end`, to and from standstill, s."""
        ...


def level_factor(motion: Any) -> float | None:
    """Level factor of a flight, or of that which a centrifuge tracks, or None of 1, and of other motions."""
    flown = motion.flight if motion is not None and motion.kind == "centrifuge" else motion
    return flown.level_factor if isinstance(flown, Flight) else None


def kind_of(motion: Any) -> str:
    """Word for a motion's kind, arm of a hub with a control point; ground where there is none."""
    if motion is None:
        return "ground"
    return str(motion.name if motion.kind == "hub" else motion.kind)


SAMPLES = 501


def notes_on(motions: Mapping[str, Any]) -> tuple[str, ...]:
    """Notes on motions by name.

    They say what was done to the records of flights, which hubs leave gravity out (it is meant in orbit, and an
    oversight on a test arm), and which standard's test a motion is. Hubs may be built or as a scenario has them.
    """
    conditioning: dict[str, list[str]] = {name: [] for name in motions}
    tests: dict[str, list[str]] = {}
    for name, motion in motions.items():
        if isinstance(motion, Flight):
            record = motion.unscaled.record
            if record is not None and record.words:
                conditioning[name].append(f"done to the record: {record.words}")
        if isinstance(motion, Hub):
            tests[name] = [f"test by {motion.standard}"] if motion.standard else []
    weightless_hubs = (
        f"{f'motion.{name}' if name else 'motion'}: gravity is left out; on a test arm give "
        'gravity = [0, 0, "-1 g"], in hub axes'
        for name, motion in motions.items()
        if motion is not None and motion.kind == "hub" and motion.gravity is None
    )
    return (*each_once(conditioning), *weightless_hubs, *each_once(tests))


def implausible_motion(motion: Motion, where: str, span: tuple[float, float], base: Any = None) -> tuple[str, ...]:
    """Warnings of what is implausible in a motion; none where JAX traces it."""
    return () if holds_jax(motion) else tuple(implausible_values(motion, where, span, base))


def implausible_values(motion: Any, where: str, span: tuple[float, float], base: Any) -> Iterator[str]:
    """Warnings about values of a motion that are unlikely in practice, such as its radius, its rate or its
    acceleration. `motion` holds no JAX arrays; `base`, if given, is its motion at times over `span`.
    """
    if motion.kind == "centrifuge":
        yield from implausible(f"{where}.arm", "arm", float(motion.geometry.arm))
        yield from _missing_gravity(motion, where)
        return
    if motion.kind == "hub":
        yield from implausible(f"{where}.radius", "radius", motion.mount.radius)
        if motion.mount.gravity is not None and np.any(motion.mount.gravity):
            yield from implausible(f"{where}.gravity", "gravity", float(np.linalg.norm(motion.mount.gravity)))
    if motion.free:
        return
    if isinstance(motion, Flight):
        yield from _flight_warnings(motion, where, span)
    base = motion.base(times(motion, span)) if base is None else base
    rate = float(np.linalg.norm(base.w_WB_B, axis=-1).max())
    acceleration = float(np.linalg.norm(base.a_WO_B, axis=-1).max())
    rate_warnings = tuple(implausible(f"{where}.rate", "rate", rate))
    # An implausible rate explains an implausible acceleration: one warning is enough.
    yield from rate_warnings or implausible(f"{where}.acceleration", "acceleration", acceleration)


def _flight_warnings(flight: Flight, where: str, span: tuple[float, float]) -> Iterator[str]:
    """Warnings about a flight: of its record, of rates that a level factor does not scale, and of parts left out."""
    if flight.record is not None:
        yield from (f"{where}.record: {note}" for note in flight.record.notes)
    if flight.level_factor is not None and flight.rates is not None:
        yield (
            f"{where}.scale: accelerations are flown × {flight.level_factor:.4g}, the body's rates as they are given: "
            "what turning adds off the root is not scaled; leave the rates out if only the load at the root counts"
        )
    part_flown = flight.part_of(*span) if span[1] > span[0] else None
    if part_flown is not None:
        yield f"{where}: {part_words(span, part_flown)} are flown, and the rest is left out"


def _missing_gravity(machine: Any, where: str) -> Iterator[str]:
    """Warn of a machine without gravity that tracks a specific force: on the earth, gravity would then act twice."""
    record = machine.flight.record
    if machine.geometry.gravity == 0 and record is not None and record.quantity == "specific-force":
        yield (
            f"{where}.gravity is false, and the record of its flight holds specific force, of which gravity is a part: "
            "on a machine that stands on the earth the specimen feels 1 g more than is said here, at every instant; "
            'give gravity = true, or quantity = "acceleration" on the record if it holds no gravity'
        )


def times(motion: Motion, span: tuple[float, float]) -> np.ndarray:
    """Times at which a motion is looked at: evenly over the span, and at its corners."""
    inside = np.clip(motion.corners((span[1] - span[0]) / SAMPLES), *span)
    return np.unique(np.concatenate([np.linspace(*span, SAMPLES), inside]))

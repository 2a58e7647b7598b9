"""Where to put the specimen: the control point, mounting and smoothing that change its response least.

About the control point C the centrifuge adds Δa(x, t) = g(t)(x − x_c) to the load of the flight (2020 (4)), and the
axis motions, so g, do not depend on where C lies in the specimen. Each measure of the response to Δa is then the size
of A(t) − x_c B(t): two histories found once, and a convex function of x_c.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import scipy.optimize

import gbeam._jax  # noqa: F401
from gbeam.analysis.comparison import CUTOFF, compare
from gbeam.analysis.loads import influence, internal_loads
from gbeam.analysis.oscillator import displacement
from gbeam.analysis.response import respond
from gbeam.analysis.stepping import first_step
from gbeam.beam import Beam
from gbeam.case import ResponseSettings
from gbeam.energy import rest_matrices
from gbeam.equations import coefficients
from gbeam.errors import InputError
from gbeam.model import Structure, rest_modes
from gbeam.motion import Base, Centrifuge, Flight
from gbeam.results import Floats, Response
from gbeam.results_place import MEASURES, Option, Placement, Proof
from gbeam.zero_phase import low_pass

_BLOCK = 4096


@dataclass(frozen=True)
class Candidate:
    """A centrifuge that tracks the flight, and what it differs in from the others: mounting, width of smoothing s."""

    mounting: str
    smoothing: float
    centrifuge: Centrifuge


@dataclass(frozen=True)
class _Histories:
    """A measure over the times compared: of the load's error at C, and of g x and g; (t, k) each; flight's own peak."""

    whole: Floats
    linear: Floats
    uniform: Floats
    scale: float

    def size(self, at: float, whole: bool) -> float:
        """Largest size with the control point at `at` m, over flight's peak."""
        values = self.linear - at * self.uniform + (self.whole if whole else 0.0)
        return float(np.sqrt(np.sum(values**2, axis=-1)).max(initial=0.0)) / self.scale


def place(
    structure: Structure,
    flight: Flight,
    candidates: Sequence[Candidate],
    settings: ResponseSettings,
    weights: Mapping[str, float],
    *,
    names: tuple[str, str] = ("flight", "centrifuge"),
    beam: Beam | None = None,
) -> Placement:
    """Find the control point, mounting and smoothing that change a specimen's response least.

    Parameters
    ----------
    structure : Structure
    flight : Flight
    candidates : sequence of Candidate
        The first as the scenario has it.
    settings : ResponseSettings
        Its span is what is looked at.
    weights : mapping of str to float
        Measures to add up, each as a fraction of its peak in flight, across the beam: ``root-shear`` and
        ``root-moment`` (quasi-static), ``vibration`` (of the first mode, at the tip), ``tip`` (quasi-static
        displacement). For each candidate they choose the control point by what Δa does, and then the candidate by
        that together with what smoothing and tracking change of the load.
    names : tuple of str
        Of flight and centrifuge.
    beam : Beam, optional
        With it the answer is proven by the model's own response, and so are the first candidate's control point and
        the middle of the beam.

    Raises
    ------
    InputError
        If a measure is unknown or none has weight, or a candidate never carries the flight's load.
    """
    _check(weights)
    length, answers = structure.length, _Answers(structure, settings)
    found: list[tuple[Option, dict[str, _Histories], Candidate]] = []
    for candidate in candidates:
        histories, accelerations = answers.histories(flight, candidate.centrifuge)

        def size(at: float, whole: bool = False, histories: dict[str, _Histories] = histories) -> float:
            return sum(weight * histories[name].size(at, whole) for name, weight in weights.items())

        best = scipy.optimize.minimize_scalar(
            size, bounds=(0, length), method="bounded", options={"xatol": 1e-7 * length}
        )
        at = float(best.x)
        option = Option(candidate.mounting, candidate.smoothing, at, size(at), size(at, True), accelerations)
        found.append((option, histories, candidate))
    # Rounding must not choose between mirror images: then the scenario's own comes first.
    found.sort(key=lambda it: float(f"{it[0].whole:.6g}"))
    option, histories, candidate = found[0]
    present = float(candidates[0].centrifuge.control_point)
    places = {"best": option.control_point, "present": present, "middle": length / 2}
    proofs = () if beam is None else _prove(structure, beam, flight, candidate.centrifuge, settings, places)
    return Placement(
        flight=names[0],
        centrifuge=names[1],
        weights=dict(weights),
        length=length,
        best=option,
        options=tuple(it[0] for it in found),
        present=present,
        values={name: {m: h.size(at, False) for m, h in histories.items()} for name, at in places.items()},
        proofs=proofs,
    )


def _check(weights: Mapping[str, float]) -> None:
    for name, weight in weights.items():
        if name not in MEASURES:
            raise InputError("measure", f"is {name!r}", f"choose of {', '.join(MEASURES)}")
        if not (np.isfinite(weight) and weight >= 0):
            raise InputError("measure", f"gives {name} the weight {weight:g}", "give weights of 0 or more")
    if not any(weights.values()):
        raise InputError("measure", "has no weight", "give one measure a weight above 0")


@eqx.filter_jit
def _load_error(flight: Flight, centrifuge: Centrifuge, t: jax.Array) -> tuple[jax.Array, ...]:
    """Load at C less the flight's, gradient less the flight's, the flight's load; axis accelerations; held or not."""
    axes = centrifuge.axes(t)
    there, here = flight.base(t), centrifuge.base(t)

    def gradient(base: Base) -> jax.Array:
        w, al = base.w_WB_B, base.al_WB_B
        wx, wy, wz = w[..., 0], w[..., 1], w[..., 2]
        return jnp.stack([-(wy**2 + wz**2), wx * wy + al[..., 2], wx * wz - al[..., 1]], axis=-1)

    turning = jnp.stack([axes.acceleration1, axes.acceleration2, axes.acceleration3], axis=-1)
    error = centrifuge.achieved(t) - there.a_WO_B
    return error, gradient(here) - gradient(there), there.a_WO_B, turning, centrifuge.held(t)


class _Answers:
    """The structure's quasi-static answers and its first mode's, to loads that are uniform or linear along the beam."""

    def __init__(self, structure: Structure, settings: ResponseSettings) -> None:
        self.step = first_step(structure, settings)
        self.time = settings.start + self.step * np.arange(round(settings.duration / self.step) + 1)
        self.influence = influence(structure)
        c = coefficients(structure.system)
        frequency, modes = rest_modes(*rest_matrices(structure.system.energy))
        self.frequency, first = float(frequency[0]), modes[:, 0]
        self.damping = float(first @ np.asarray(c.damping) @ first) / (2 * self.frequency)
        per_q = np.asarray(jax.jacfwd(structure.displacement)(jnp.zeros(structure.size)))[-1]
        self.tip = float(np.abs(per_q @ first).max())
        self.uniform = np.asarray(c.f_a) @ first
        self.linear = np.array([0.0, np.asarray(c.f_al)[2] @ first, -np.asarray(c.f_al)[1] @ first])

    def histories(
        self, flight: Flight, centrifuge: Centrifuge
    ) -> tuple[dict[str, _Histories], tuple[float, float, float]]:
        """Every measure's, and the largest accelerations of the axes, rad/s²."""
        error, gradient, load, turning, held = self._sampled(flight, centrifuge)
        covered = ~held
        if not covered.any():
            raise InputError("tracks", "is never carried: the target is held all the time", "lower idle")
        it, across = self.influence, np.array([0.0, 1.0, 1.0])

        def quasi_static(uniform: Floats, linear: Floats) -> _Histories:
            parts = ((error * uniform), (gradient * linear), (gradient * uniform))
            own = (load * uniform * across)[covered]
            whole, linear_part, uniform_part = ((part * across)[covered] for part in parts)
            return _Histories(whole, linear_part, uniform_part, _peak(own))

        def vibration(force: Floats) -> Floats:
            trend = force / self.frequency**2
            return self.tip * (displacement(force, self.frequency, self.damping, self.step) - trend)[covered, None]

        found = {
            "root-shear": quasi_static(it.force_uniform, it.force_linear),
            "root-moment": quasi_static(it.moment_uniform, it.moment_linear),
            "tip": quasi_static(it.tip_uniform, it.tip_linear),
        }
        transverse = self.uniform * across
        found["vibration"] = _Histories(
            vibration(error @ transverse), vibration(gradient @ self.linear), vibration(gradient @ transverse),
            scale=found["tip"].scale,
        )  # fmt: skip
        accelerations = np.abs(turning).max(axis=0)
        return found, (float(accelerations[0]), float(accelerations[1]), float(accelerations[2]))

    def _sampled(self, flight: Flight, centrifuge: Centrifuge) -> list[np.ndarray]:
        """In blocks of one compiled shape."""
        count = len(self.time)
        padded = np.concatenate([self.time, np.repeat(self.time[-1], -count % _BLOCK)])
        parts = [_load_error(flight, centrifuge, jnp.asarray(t)) for t in np.split(padded, len(padded) // _BLOCK)]
        return [np.concatenate([np.asarray(part[k]) for part in parts])[:count] for k in range(5)]


def _peak(values: Floats) -> float:
    peak = float(np.linalg.norm(values, axis=-1).max(initial=0.0))
    if peak == 0:
        raise InputError("tracks", "loads the beam along its axis only", "track a flight that loads it across")
    return peak


class _Carried(eqx.Module):
    """A base in translation with the load that a centrifuge makes at its control point: no mismatch anywhere."""

    centrifuge: Centrifuge

    def base(self, t: jax.Array) -> Base:
        load = self.centrifuge.achieved(t)
        return Base(load, jnp.zeros_like(load), jnp.zeros_like(load))

    @property
    def breaks(self) -> jax.Array:
        return self.centrifuge.breaks


def _prove(
    structure: Structure,
    beam: Beam,
    flight: Flight,
    centrifuge: Centrifuge,
    settings: ResponseSettings,
    places: Mapping[str, float],
) -> tuple[Proof, ...]:
    """The model's own response at each control point against that in flight."""

    def computed(motion: Flight | Centrifuge) -> Response:
        response = respond(structure, motion, settings)
        return replace(response, loads=internal_loads(structure, beam, response))

    there, proofs = computed(flight), []
    carried = respond(structure, _Carried(centrifuge), settings)  # type: ignore[arg-type]  # a motion like any other
    step = float(there.time[1] - there.time[0])
    cutoff = CUTOFF * float(there.frequencies[0]) / (2 * np.pi)
    for name, at in places.items():
        here = computed(eqx.tree_at(lambda it: it.control_point, centrifuge, jnp.asarray(at)))
        answer = compare(there, here)
        swing = (here.tip - carried.tip)[:, 1:]
        swing = swing - low_pass(swing, step, cutoff)
        moment = np.nan if answer.root is None else float(answer.root.moment_difference[1:].max())
        apart, swung = (
            float(np.linalg.norm(values[answer.covered], axis=1).max()) for values in (answer.difference[:, 1:], swing)
        )
        proofs.append(Proof(name, at, apart, swung, moment))
    return tuple(proofs)

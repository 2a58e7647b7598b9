"""The time from which the frozen equations of a body in a run are no longer stable.

The straight beam is stable while its stiffness, with the terms of the base's motion and of the loads, is positive
definite. Of a complete model it is the bent beam. Where loads follow the beam, the eigenvalues decide. A disturbance
grows by exp ∫ Re λ dt: a load that acts for a moment does nothing, whatever its size.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from gbeam.analysis.steady.equilibrium import expanded
from gbeam.arrays.namespace import Array
from gbeam.mechanics.equations.linear import Coefficients
from gbeam.mechanics.structure import Structure
from gbeam.numerics.eigen import eigenvalues, growth_rate, positive_definite, stability_margin, symmetric, unsymmetric
from gbeam.results.parts import Base

_BLOCK = 2000  # times whose stiffness is computed together
_STRETCHES, _MOST = 4, 32  # stretches whose growth is computed, and times of each, at most
_SHARE = 0.01  # of the elastic stiffness: a term that takes less of it is no cause
_ROW, _COLUMN = np.tril_indices(3, -1)


class Loss(NamedTuple):
    """A stretch of time, s, in which a disturbance grows by exp(`growth`), and its causes at the start, in words."""

    start: float
    end: float
    growth: float
    flutter: bool
    causes: tuple[str, ...]


class Excitation(NamedTuple):
    """Motion of the base (t, 3) and components of the loads (t, loads, 6), or those of one time."""

    a_WO_B: Array
    w_WB_B: Array
    alpha_WB_B: Array
    loads: Array | None = None

    def select(self, times: Any) -> Excitation:
        """Base and loads at an index, slice or array of the times."""
        return Excitation(*(None if values is None else values[times] for values in self))

    def interpolate(self, before: int, after: int, share: float) -> Excitation:
        """Base and loads interpolated a share of the way between two times, given by their indices."""
        ends = zip(self.select(before), self.select(after), strict=True)
        return Excitation(*(None if a is None else a + share * (b - a) for a, b in ends))


def worst_loss(structure: Structure, time: Array, base: Base, q: Array) -> Loss | None:
    """Find the stretch of time in which a disturbance grows most about q (t, n), or None if none grows.

    Of a complete model, growth that ends within a stretch does not count: there it is on its way to a stable shape.
    """
    c = structure.coefficients
    loads = None if c.loads is None or structure.history is None else structure.history(time)
    excitation = Excitation(base.a_WO_B, base.w_WB_B, base.alpha_WB_B, loads)

    def matrices(i: int) -> tuple[Array, Array, Array]:
        """M, C and K that decide on growth at a time's index."""
        departures = c if structure.linear else expanded(structure, q[i])[0]
        return departures.mass, *departures.frozen(*excitation.select(i))

    def loss(part: Array) -> Loss | None:
        """Loss over a stretch of indices, by growth rates at some of them."""
        looked_at = part[:: -(-len(part) // _MOST)]
        until = np.append(looked_at[1:], min(part[-1] + 1, len(time) - 1))
        rate = np.array([growth_rate(*matrices(i)) for i in looked_at])
        run = np.cumsum(np.diff(rate > 0, prepend=False))  # numbers of runs of growth and of decay
        growth = np.bincount(run, rate * (time[until] - time[looked_at]))
        if not structure.linear:
            growth[: run[-1]] = 0.0
        if not growth.any():
            return None
        steepest = np.flatnonzero(run == growth.argmax())
        first = int(looked_at[steepest[0]])
        previous = int(looked_at[steepest[0] - 1]) if steepest[0] else max(first - 1, 0)
        margins = stability_margin(*matrices(previous)), stability_margin(*matrices(first))
        share = margins[0] / (margins[0] - margins[1]) if margins[0] > 0 > margins[1] else 1.0
        return Loss(
            start=float(time[previous] + share * (time[first] - time[previous])),
            end=float(time[until[steepest[-1]]]),
            growth=float(growth.max()),
            flutter=unsymmetric(matrices(first)[2]),
            causes=_causes(structure, excitation.interpolate(previous, first, share), matrices(first)),
        )

    if not c.size:
        return None
    doubtful, score = _doubtful(c, excitation)
    stretches = np.split(doubtful, np.flatnonzero(np.diff(doubtful) > 1) + 1) if len(doubtful) else []
    stretches.sort(key=lambda part: -score[part].sum())
    losses = [loss(part) for part in stretches[:_STRETCHES]]
    return max(filter(None, losses), key=lambda stretch: stretch.growth, default=None)


def holds(structure: Structure, time: float, base: Base, q: Array) -> bool:
    """True if a structure that rests at coordinates `q` (n,) at a time, s, stays there in a motion (3,) of its root."""
    frozen = structure.at_time(time)
    c, values = expanded(frozen, q)[0], frozen.load_values
    damping, stiffness = c.frozen(base.a_WO_B, base.w_WB_B, base.alpha_WB_B, values)
    # Loads that follow the beam may shake it, which inertia decides.
    return positive_definite(stiffness) if values is None else stability_margin(c.mass, damping, stiffness) > 0


def _doubtful(c: Coefficients, excitation: Excitation) -> tuple[Array, Array]:
    """Indices of times at which the straight beam may be unstable, and bounds (t,) 1/s of the growth.

    Eigenvalues are computed only where the sum of the terms' bounds reaches the elastic stiffness. Loads that follow
    the beam, which these bounds do not cover, make the growth infinite.
    """
    scale = np.linalg.inv(np.linalg.cholesky(c.stiffness))  # by which the elastic stiffness is one
    w, bound = excitation.w_WB_B, np.zeros(len(excitation.w_WB_B))
    terms = [c.k_a, c.k_al, c.k_ww[_ROW, _COLUMN], c.k_ww[range(3), range(3)]]
    sizes = [excitation.a_WO_B, excitation.alpha_WB_B, 2 * w[:, _ROW] * w[:, _COLUMN], w**2]
    if excitation.loads is not None and c.loads is not None:
        slope, values = c.loads.slope[:, :, 6:].reshape(-1, c.size, c.size), excitation.loads.reshape(len(w), -1)
        terms.append(-slope)
        sizes.append(values)
        bound[np.any(values[:, [unsymmetric(matrix) for matrix in slope]], axis=1)] = np.inf
    size = np.concatenate(sizes, axis=1)
    driven = size.any(axis=0)
    size, term = size[:, driven], symmetric(np.concatenate(terms)[driven])
    share = np.linalg.eigvalsh(scale @ term @ scale.T)
    removed = np.maximum(size, 0) @ np.maximum(-share[:, 0], 0) + np.maximum(-size, 0) @ np.maximum(share[:, -1], 0)
    large = np.flatnonzero((removed >= 1.0) & (bound == 0))
    for block in (large[i : i + _BLOCK] for i in range(0, len(large), _BLOCK)):
        bound[block] = np.sqrt(np.maximum(-lowest_over_time(c, excitation.select(block)), 0))
    return np.flatnonzero(bound), bound


def lowest_over_time(c: Coefficients, excitation: Excitation) -> Array:
    """Lowest eigenvalue of K, M-normalised, over time: negative where K is not positive definite, rad²/s²."""
    scale = np.linalg.inv(np.linalg.cholesky(c.mass))
    return np.linalg.eigvalsh(scale @ symmetric(c.frozen(*excitation)[1]) @ scale.T)[..., 0]


def _causes(structure: Structure, excitation: Excitation, matrices: tuple[Array, Array, Array]) -> tuple[str, ...]:
    """Name the terms of base and loads that take stiffness from the fastest growing mode, or feed it."""
    c, (a, w, alpha, loads) = structure.coefficients, excitation
    value, modes = eigenvalues(*matrices)
    mode = modes[:, value.real.argmax()]

    def stiffness_share(stiffness: Array) -> float:
        """Share of the mode's elastic stiffness that a term takes away, or feeds by asymmetry."""
        share = (mode.conj() @ stiffness @ mode) / (mode.conj() @ c.stiffness @ mode).real
        return float(max(-share.real, abs(share.imag)))

    terms = {
        f"the base turns at {np.linalg.norm(w):.4g} rad/s": np.einsum("i,j,ijnm->nm", w, w, c.k_ww),
        f"its rate changes by {np.linalg.norm(alpha):.4g} rad/s²": symmetric(np.tensordot(alpha, c.k_al, 1)),
        f"the root is pushed with {np.linalg.norm(a):.4g} m/s²": np.tensordot(a, c.k_a, 1),
    }
    if loads is not None and c.loads is not None:
        points = np.zeros(0) if structure.work is None else np.bincount(structure.work.load)
        for k, (values, slope) in enumerate(zip(loads, c.loads.slope[:, :, 6:], strict=True)):
            if structure.heated and k == len(loads) - 1:
                rise = float(values[0])
                words = f"its temperature is {abs(rise):.4g} K {'above' if rise > 0 else 'below'} its reference"
                terms[words] = -rise * slope[0]
                continue
            force, moment = np.linalg.norm(values[:3]), np.linalg.norm(values[3:])
            size = f"{force:.4g} N" if force > 0 else f"{moment:.4g} N m"
            words = f"beam.loads[{k}] acts with {size}{'/m' if points[k] > 1 else ''}"
            terms[words] = -np.tensordot(values, slope, 1)
    shares = {words: stiffness_share(stiffness) for words, stiffness in terms.items()}
    return tuple(words for words, share in shares.items() if share > min(_SHARE, max(shares.values()) / 2))

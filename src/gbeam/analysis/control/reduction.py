"""Smaller state-space models: truncation by modes, and balanced truncation."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import scipy.linalg

from gbeam.arrays.types import Floats
from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.results.state_space import Signal, StateSpace, Truncation

Parts = tuple[StateSpace, StateSpace]
RIGID = 1e-7  # of the largest eigenvalue: a smaller one is zero, as of a free hub's angle
POINTS = 200  # frequencies at which gains are compared
REACHED = 1e-14  # of the largest Hankel singular value: a smaller one is rounding
DECAYS = 1e-9  # of the largest eigenvalue: what decays more slowly counts as undamped


def _named(system: StateSpace, a: Floats, b: Floats, c: Floats, d: Floats, stem: str) -> StateSpace:
    """The system with other matrices, and states named by a stem and a number."""
    states = tuple(Signal(f"{stem}_{k + 1}", "1") for k in range(len(a)))
    return replace(system, a=a, b=b, c=c, d=d, states=states, state=np.zeros(len(a)))


def _split(system: StateSpace, chosen: Callable[[complex], bool]) -> Parts:
    """Split a system into a part with the chosen eigenvalues, which keeps D, and a part with the others.

    An ordered Schur form and Sylvester's equation for the coupling of its blocks do so for multiple poles, too.
    """
    schur, basis, count = scipy.linalg.schur(system.a, output="real", sort=lambda re, im=0.0: chosen(complex(re, im)))
    first, second = schur[:count, :count], schur[count:, count:]
    coupling = scipy.linalg.solve_sylvester(first, -second, -schur[:count, count:])
    b, c = basis.T @ system.b, system.c @ basis
    return (
        _named(system, first, b[:count] - coupling @ b[count:], c[:, :count], system.d, "slow"),
        _named(system, second, b[count:], c[:, :count] @ coupling + c[:, count:], 0 * system.d, "fast"),
    )


@typed
def modal_truncation(system: StateSpace, modes: int) -> StateSpace:
    """Keep the slowest modes. What the others add in statics goes into D.

    Parameters
    ----------
    system : StateSpace
    modes : int
        Number of distinct |λ| that are kept, the lowest: two states for an oscillation. What has none, the turning of a
        free hub and the rates of a base, is kept besides.

    Raises
    ------
    InputError
        If there are not so many modes.

    Examples
    --------
    >>> strip = gb.Section.rectangle(width=0.02, thickness=0.004)
    >>> beam = gb.Beam(0.3, strip, gb.Material(2700, 70e9), damping_ratio=0.01)
    >>> structure = gb.assemble(beam, "FOAM", axial=1, y=2, z=2)
    >>> plant = gb.linearize(structure, gb.Flight(z=0.0))
    >>> gb.modal_truncation(plant, modes=2).a.shape
    (4, 4)
    """
    size = np.abs(scipy.linalg.eigvals(system.a))
    levels = [RIGID * size.max()]
    for value in np.sort(size):
        if value > levels[-1] * (1 + 1e-6):
            levels.append(float(value))
    last = len(levels) - 1
    if not 1 <= modes <= last:
        raise InputError("modes", f"is {modes}", f"give 1 to {last}")
    if modes == last:
        return system
    limit = (levels[modes] + levels[modes + 1]) / 2
    slow, fast = _split(system, lambda value: abs(value) < limit)
    is_slow = 2 * np.pi * system.frequency < limit
    errors = None if system.errors is None else system.errors[is_slow]
    static = -fast.c @ np.linalg.solve(fast.a, fast.b)
    band = levels[1] / 2, levels[modes]
    left_out = truncation("modal", system, replace(fast, d=-static), len(fast.a), np.zeros(0), band)
    return replace(slow, d=slow.d + static, frequency=system.frequency[is_slow], errors=errors, truncation=left_out)


@typed
def balanced_truncation(system: StateSpace, order: int) -> tuple[StateSpace, Floats]:
    """Balanced truncation (Moore 1981): keep what inputs reach and outputs see most.

    Parameters
    ----------
    system : StateSpace
    order : int
        Number of states kept of the part that decays; what does not decay, such as a free hub's turning or an
        undamped mode, is kept whole.

    Returns
    -------
    StateSpace, (k,) Hankel singular values of the decaying part
        Its `truncation` has the bound of the error: twice the sum of the values left out.

    Raises
    ------
    InputError
        If nothing decays, or not so much.

    Examples
    --------
    >>> strip = gb.Section.rectangle(width=0.02, thickness=0.004)
    >>> beam = gb.Beam(0.3, strip, gb.Material(2700, 70e9), damping_ratio=0.01)
    >>> structure = gb.assemble(beam, "FOAM", axial=1, y=2, z=2)
    >>> plant = gb.linearize(structure, gb.Flight(z=0.0))
    >>> small, hankel = gb.balanced_truncation(plant, order=4)
    >>> plant.a.shape, small.a.shape
    ((10, 10), (4, 4))
    """
    tolerance = DECAYS * np.abs(scipy.linalg.eigvals(system.a)).max()
    kept, decaying = _split(system, lambda value: value.real > -tolerance)
    k = len(decaying.a)
    if not 1 <= order <= k:
        reason = "undamped modes cannot be balanced; give the beam a damping_ratio" if k == 0 else f"give 1 to {k}"
        raise InputError("order", f"is {order}, and {k} states decay", reason)
    reach = scipy.linalg.solve_continuous_lyapunov(decaying.a, -decaying.b @ decaying.b.T)
    see = scipy.linalg.solve_continuous_lyapunov(decaying.a.T, -decaying.c.T @ decaying.c)

    def root(gramian: Floats) -> Floats:
        """A factor L of a gramian L Lᵀ, which may be singular."""
        value, vector = np.linalg.eigh((gramian + gramian.T) / 2)
        return vector * np.sqrt(np.maximum(value, 0))

    left, hankel, right = np.linalg.svd(root(see).T @ root(reach))
    count = int((hankel > REACHED * hankel.max(initial=0.0)).sum())
    if order > count:
        fix = f"give 1 to {count}" if count else "give it an input that moves them, such as a force or an effort"
        raise InputError("order", f"is {order}, and inputs reach and outputs see {count} of the states that decay", fix)
    scale = 1 / np.sqrt(hankel[:order])
    into = scale[:, None] * (root(see) @ left[:, :order]).T
    out = root(reach) @ right[:order].T * scale
    a = scipy.linalg.block_diag(kept.a, into @ decaying.a @ out)
    b, c = np.concatenate([kept.b, into @ decaying.b]), np.concatenate([kept.c, decaying.c @ out], axis=1)
    small = _named(system, a, b, c, system.d, "balanced")
    difference = replace(
        system,
        a=scipy.linalg.block_diag(decaying.a, a[len(kept.a) :, len(kept.a) :]),
        b=np.concatenate([decaying.b, b[len(kept.a) :]]),
        c=np.concatenate([decaying.c, -c[:, len(kept.a) :]], axis=1),
        d=0 * system.d,
    )
    size = np.abs(scipy.linalg.eigvals(system.a))
    band = size[size > RIGID * size.max()].min() / 2, 2 * size.max()
    left_out = truncation("balanced", system, difference, k - order, hankel, band)
    return replace(small, frequency=np.zeros(0), errors=None, truncation=left_out), hankel


def truncation(
    method: str, system: StateSpace, difference: StateSpace, states: int, hankel: Floats, band: tuple[float, float]
) -> Truncation:
    """Record of a truncation that leaves out `states`.

    It has the largest gains of the system and of the `difference` that the truncation makes, over a band in rad/s.
    """
    start, end = band
    poles = np.abs(scipy.linalg.eigvals(difference.a))  # where its gain has peaks
    frequencies = np.geomspace(start, end, POINTS, endpoint=False)  # short of the last pole kept, which may be undamped
    error = _largest_gains(difference, np.concatenate([[0.0, end], frequencies, poles[poles <= end]]))
    peaks = _largest_gains(system, frequencies)
    # A gain is compared with the largest of those between the same units.
    output_units = np.array([signal.unit for signal in system.outputs])
    input_units = np.array([signal.unit for signal in system.inputs])
    gain = np.empty(peaks.shape)
    for output in set(output_units.tolist()):
        for source in set(input_units.tolist()):
            block = np.ix_(output_units == output, input_units == source)
            gain[block] = peaks[block].max()
    return Truncation(method, states, hankel, start / (2 * np.pi), end / (2 * np.pi), error, gain)


def _largest_gains(system: StateSpace, rates: Floats) -> Floats:
    """Largest gains (p, m) at circular frequencies, rad/s."""
    response = [system.c @ np.linalg.solve(1j * w * np.eye(len(system.a)) - system.a, system.b) for w in rates]
    return np.abs(np.array(response) + system.d).max(axis=0)

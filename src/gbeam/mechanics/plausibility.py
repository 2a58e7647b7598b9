"""Doubts about an answer before it is computed: implausible values, and directions that the model leaves out."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from gbeam.arrays.namespace import holds_jax, is_traced
from gbeam.mechanics.models import TORSION
from gbeam.mechanics.structure import Structure
from gbeam.motion.protocol import Motion, implausible_values, times

NOTICED = 0.01  # of the largest: a smaller share along a direction without shapes is none
STIFF = 10.0  # times the other direction: from there on the driven one should be meant
SLOWEST, FASTEST = 1e-3, 1e6  # Hz, of a beam's lowest natural frequency


def input_warnings(
    structure: Structure,
    motion: Motion | None = None,
    *,
    name: str = "",
    span: tuple[float, float] = (0.0, 0.0),
    base: Any = None,
) -> tuple[str, ...]:
    """Warn of what is implausible in any analysis's input, also in the `base` at times that matter; never where JAX
    traces it.
    """
    if structure.traced or holds_jax(motion):
        return ()
    where = f"motion.{name}" if name else "motion"
    warnings = [*structure.warnings, *(_frequency(structure) if structure.size else ())]
    if motion is not None:
        warnings += implausible_values(motion, where, span, base)
        if base is None and motion.kind != "centrifuge" and not motion.free:
            base = motion.base(times(motion, span))
        elif base is None and motion.free:
            base = motion.mount.base(*np.zeros((3, 1)))  # type: ignore[attr-defined]
    warnings += _unstiffened(structure, base, where)
    warnings += _without_shapes(structure, base, where, span)
    return (*warnings, *_twisting(structure, span), *_on_edge(structure, motion, base, where))


def _frequency(structure: Structure) -> Iterator[str]:
    lowest = float(structure.rest[0][0]) / (2 * np.pi)
    if not structure.warnings and not SLOWEST <= lowest <= FASTEST:
        yield (
            f"the beam's lowest natural frequency at rest is {lowest:.3g} Hz, outside the plausible {SLOWEST:g} to "
            f"{FASTEST:g} Hz; are the units of length, section and material right?"
        )


def _unstiffened(structure: Structure, base: Any, where: str) -> Iterator[str]:
    """How large in a motion the stiffness is that a structure by matrices lacks.

    A load a over its mass bends a cantilever by about a/ω², and bends it by its own angle more or less: the square of
    its lowest frequency changes by about a/(ω² L), and by about Ω²/ω² in a rotation.
    """
    if not structure.unstiffened or base is None or is_traced(base.a_WO_B):
        return
    length, square = float(structure.length), float(structure.rest[0][0]) ** 2
    size = [np.linalg.norm(np.reshape(each, (-1, 3)), axis=-1) for each in (base.a_WO_B, base.w_WB_B, base.alpha_WB_B)]
    share = float((size[0] / length + size[1] ** 2 + size[2]).max()) / square
    if share > 0:
        yield (
            f"{where} loads the body so that the stiffness that is left out changes the square of its lowest "
            f"frequency by the order of {100 * share:.2g} %"
        )


def _without_shapes(structure: Structure, base: Any, where: str, span: tuple[float, float]) -> Iterator[str]:
    """Accelerations and loads across the beam along which the model has no shape: the beam stays straight there."""
    still = structure.axes_without_shapes
    if structure.field is None or not still:
        return
    if base is not None and not is_traced(base.a_WO_B):
        size = np.abs(np.reshape(base.a_WO_B, (-1, 3))).max(axis=0)
        for axis in still:
            if size[axis] > NOTICED * size.max():
                yield _remark(f"{where} accelerates the root, or gravity does,", f"{size[axis]:.3g} m/s²", axis)
    if structure.history is None:
        return
    values = _largest_loads(structure.history, span)
    for axis in still:
        # A moment about z bends along y, one about y along z.
        for part, column, unit in (("force", axis, "N"), ("moment", 6 - axis, "N m")):
            largest = values[:, 3 * (column // 3) : 3 * (column // 3) + 3].max(initial=0.0)
            for i in np.flatnonzero(values[:, column] > NOTICED * largest):
                yield _remark(f"beam.loads[{i}].{part} bends the beam", f"{values[i, column]:.3g} {unit}", axis)


def _twisting(structure: Structure, span: tuple[float, float]) -> Iterator[str]:
    """Moments about the beam's axis of a model that does not turn by them."""
    if structure.field is None or structure.history is None or structure.counts[3]:
        return
    values = _largest_loads(structure.history, span)[:, 3:]
    for i in np.flatnonzero(values[:, 0] > NOTICED * values.max(initial=0.0)):
        yield (
            f"beam.loads[{i}].moment twists the beam about x with up to {values[i, 0]:.3g} N m, and "
            f"{structure.kind} does not turn by it: {TORSION}"
        )


def _on_edge(structure: Structure, motion: Any, base: Any, where: str) -> Iterator[str]:
    """A beam that a hub speeds up or slows down against its stiff direction, where nothing says that this is meant."""
    if motion is None or motion.kind != "hub" or motion.setting_angle is not None or structure.source is None:
        return
    if not (motion.free or (base is not None and np.any(base.alpha_WB_B))):
        return
    beam = structure.source.beam
    _, along_z, along_y = (np.mean(each) for each in beam.rigidities(np.linspace(0, beam.length, 41)))
    if along_y > STIFF * along_z:
        yield (
            f"{where} bends the beam along y, in its plane of rotation, where it is {along_y / along_z:.3g} times as "
            f'stiff as along z; give {where}.setting_angle = "90 deg" to turn it, or "0 deg" if this is meant'
        )


def _largest_loads(history: Any, span: tuple[float, float]) -> Any:
    """Largest sizes of the components of each load over a span of time, (loads, 6)."""
    inside = np.clip(history.corners((span[1] - span[0]) / 200), *span)
    when = np.union1d(np.linspace(*span, 201), inside)
    return np.abs(history(when)).max(axis=0)


def _remark(what: str, size: str, axis: int) -> str:
    way = "xyz"[axis]
    return (
        f"{what} along {way} with up to {size}, where the model has no shapes: the beam stays straight there; "
        f"give model.modes.{way} = 1 or more"
    )

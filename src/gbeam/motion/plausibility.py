"""What is implausible in a motion: its sizes, and how fast it goes over a span of time."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from gbeam.arrays.namespace import holds_jax
from gbeam.guards.plausibility import implausible
from gbeam.motion.protocol import Motion

SAMPLES = 501


def implausible_motion(motion: Motion, where: str, span: tuple[float, float], base: Any = None) -> tuple[str, ...]:
    """Warnings of what is implausible in a motion; none where JAX traces it.

    Parameters
    ----------
    motion : Motion
        Of a machine only the arm is looked at: what it does follows from the flight, and takes a plan to know.
    where : str
        Path of the motion in the scenario.
    span : tuple of float
        First and last time, s.
    base : Base or BaseMotion, optional
        What the motion is at the times that matter, (t, 3), where it is known.
    """
    return () if holds_jax(motion) else tuple(implausible_values(motion, where, span, base))


def implausible_values(motion: Any, where: str, span: tuple[float, float], base: Any) -> Iterator[str]:
    """The same of a motion that holds nothing of JAX."""
    if motion.kind == "centrifuge":
        yield from implausible(f"{where}.arm", "arm", float(motion.geometry.arm))
        return
    if motion.kind == "hub":
        yield from implausible(f"{where}.radius", "radius", motion.mount.radius)
        if motion.mount.gravity is not None and np.any(motion.mount.gravity):
            yield from implausible(f"{where}.gravity", "gravity", float(np.linalg.norm(motion.mount.gravity)))
    if motion.free:
        return
    base = motion.base(times(motion, span)) if base is None else base
    rate, load = (float(np.linalg.norm(each, axis=-1).max()) for each in (base.w_WB_B, base.a_WO_B))
    odd = tuple(implausible(f"{where}.rate", "rate", rate))
    yield from odd or implausible(f"{where}.acceleration", "acceleration", load)


def times(motion: Motion, span: tuple[float, float]) -> np.ndarray:
    """Times at which a motion is looked at: evenly over the span, and at its corners."""
    inside = np.clip(motion.corners((span[1] - span[0]) / SAMPLES), *span)
    return np.unique(np.concatenate([np.linspace(*span, SAMPLES), inside]))

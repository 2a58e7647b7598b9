"""Random beams and base motions of one scale, and how often theorems are tried.

Linear models are NumPy; of the exact model there is one size, so that its programs are compiled once.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from hypothesis import HealthCheck, Phase, settings
from hypothesis import strategies as st

from gbeam import Beam, Material, PointMass, Root, Section, Structure, modes
from gbeam.motion import Motion

# A counterexample is as random as any example: it is not made smaller, which takes minutes.
theorem = settings(max_examples=12, phases=[Phase.generate], suppress_health_check=list(HealthCheck))
few = settings(theorem, max_examples=4)  # where an example takes a while

EXACT = (1, 2, 2)  # shapes of the exact model


def numbers(low: float, high: float) -> st.SearchStrategy[float]:
    """Floats of an interval, both ends included, a thousandth of it apart: hardly any is special."""
    return st.integers(0, 1000).map(lambda k: low + (high - low) * k / 1000)


def vectors(size: float, count: int = 3) -> st.SearchStrategy[np.ndarray]:
    """Vectors with components of up to `size`."""
    return st.lists(numbers(-size, size), min_size=count, max_size=count).map(np.array)


@st.composite
def beams(
    draw: st.DrawFn,
    *,
    square: bool = False,
    bodies: bool = True,
    springs: bool = False,
    taper: bool = True,
    damping: float | None = None,
) -> Beam:
    """Beams of 0.2 to 2 m, slender, of light and heavy metals.

    Parameters
    ----------
    square : bool
        Whether the section is the same along y and along z.
    bodies : bool
        Whether there is a body off the axis at some place, with rotary inertia.
    springs : bool
        Whether the root may turn on springs.
    taper : bool
        Whether width and thickness fall towards the tip.
    damping : float, optional
        Modal damping ratio; by default up to 5 %.
    """
    length = draw(numbers(0.2, 2.0))
    thickness = length * draw(numbers(0.01, 0.03))
    width = thickness if square else thickness * draw(numbers(1.0, 4.0))
    material = Material(draw(numbers(1500.0, 9000.0)), draw(numbers(4e10, 2.2e11)))
    mass = material.density * length * width * thickness
    section = Section.rectangle(width, thickness)
    if taper:
        ends = [1.0, draw(numbers(0.5, 1.0))]
        section = Section.rectangle(width * np.array(ends), thickness * np.array(ends), [0.0, length])
    more: dict[str, Any] = {}
    if bodies:
        m = mass * draw(numbers(0.1, 1.0))
        arm = thickness if square else 0.05 * length
        inertia = m * arm**2 * np.array([1.0, 1.0, 1.0] if square else [1.0, 1.2, 1.5])
        offset = (0.5 * arm, 0.0, 0.0) if square else tuple(arm * draw(vectors(1.0)))
        more["masses"] = [PointMass(length * draw(numbers(0.3, 1.0)), m, inertia=tuple(inertia), offset=offset)]
    if springs:
        soft = material.youngs_modulus * width * thickness**3 / 12 / length
        more["root"] = Root(rotation_y=soft * draw(numbers(1.0, 20.0)), rotation_z=soft * draw(numbers(1.0, 20.0)))
    ratio = draw(numbers(0.0, 0.05)) if damping is None else damping
    return Beam(length, section, material, damping_ratio=ratio, **more)


def first_frequency(beam: Beam) -> float:
    """About that of the first mode along z, rad/s: the scale of time."""
    s, m = beam.section.at(0.0), beam.material
    return float(3.516 * np.sqrt(m.youngs_modulus * s.inertia_y / (m.density * s.area)) / beam.length**2)


def frequencies(structure: Structure, motion: Motion, *, gyroscopic: bool = True) -> np.ndarray:
    """Frequencies by `gbeam.modes`, without their errors, which take longer than all else; Hz."""
    return modes(structure, motion, gyroscopic=gyroscopic, errors=False).frequency

"""What is implausible in a beam: its values one by one, and one against the other."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from gbeam.arrays.namespace import holds_jax
from gbeam.guards.plausibility import implausible
from gbeam.structure.beam import Beam
from gbeam.structure.section import KINDS

STOCKIEST, SLENDEREST = 20.0, 2e5  # length over radius of gyration; a rectangle's is 0.29 of its thickness
LEANEST, FATTEST = 1e-3, 30.0  # radius of gyration over the root of the area
HEAVIEST = 1e3  # mass of a body over the beam's


def implausible_beam(beam: Beam, bends: tuple[bool, bool]) -> tuple[str, ...]:
    """Warnings of what is implausible in a beam, with the scenario's names; none where JAX traces it.

    Parameters
    ----------
    beam : Beam
    bends : tuple of bool
        Whether it can bend along y, and along z, in its model: slenderness matters there only.
    """
    bodies = [(body.mass, body.inertia, body.offset) for body in beam.masses]
    material = (beam.material.density, beam.material.youngs_modulus, beam.material.yield_strength)
    if holds_jax(beam.length, material, list(beam.section.dimensions.values()), bodies, beam.damping_ratio):
        return ()
    alone = (*_material(beam), *_dimensions(beam))
    # A wrong unit makes ratios wrong as well: they are looked at where each value is plausible.
    return (*alone, *_bodies(beam)) if alone else (*_proportions(beam, bends), *_bodies(beam))


def _material(beam: Beam) -> Iterator[str]:
    material = beam.material
    yield from implausible("beam.material.density", "density", material.density)
    yield from implausible("beam.material.youngs_modulus", "modulus", material.youngs_modulus)
    if material.yield_strength is not None:
        yield from implausible("beam.material.yield_strength", "strength", material.yield_strength)
    if beam.damping_ratio is not None:
        yield from implausible("beam.damping_ratio", "damping", float(np.max(beam.damping_ratio)))


def _dimensions(beam: Beam) -> Iterator[str]:
    yield from implausible("beam.length", "length", beam.length)
    for name, values in beam.section.dimensions.items():
        largest, kind = max(values), KINDS.get(name, "section")
        odd = implausible(f"beam.section.{name}", kind, largest)
        odd = odd or implausible(f"beam.section.{name}", kind, min(values))
        yield from odd
        if not odd and kind == "section" and largest > beam.length:
            yield (
                f"beam.section.{name} is {largest:g} m, more than the beam's length, {beam.length:g} m; "
                + (f"did you mean {largest:g} mm?" if 3e-3 * largest < beam.length else "are their units right?")
            )


def _proportions(beam: Beam, bends: tuple[bool, bool]) -> Iterator[str]:
    at = np.asarray(beam.section.stations or (0.0,))
    section = beam.section.at(at)
    for axis, bent, inertia, name in (("y", bends[0], section.inertia_z, "z"), ("z", bends[1], section.inertia_y, "y")):
        gyration = np.sqrt(inertia / section.area)
        shape = gyration / np.sqrt(section.area)
        if not (shape.min() > LEANEST and shape.max() < FATTEST):
            yield (
                f"beam.section.inertia_{name} and area make a radius of gyration of {gyration.max():g} m in an area of "
                f"{section.area.max():g} m^2; are their units right?"
            )
        elif bent and not STOCKIEST < beam.length / gyration.max() < SLENDEREST:
            ratio = beam.length / gyration.max()
            why = (
                "the theory of slender beams, without shear, is then wrong by several per cent"
                if ratio < STOCKIEST
                else "nothing as slender carries its own weight"
            )
            yield (
                f"beam.length, {beam.length:g} m, is {ratio:.3g} times the section's radius of gyration along {axis}, "
                f"{gyration.max():.3g} m: {why}; are the units of length and section right?"
            )


def _bodies(beam: Beam) -> Iterator[str]:
    own = _mass(beam)
    for i, body in enumerate(beam.masses):
        where = f"beam.masses[{i}]"
        if body.mass > HEAVIEST * own:
            times = f"{body.mass / own:.3g} times the beam's"
            yield f"{where}.mass is {body.mass:g} kg, {times}; did you mean {body.mass:g} g?"
        arm = max(map(abs, body.offset))
        if arm > beam.length:
            yield f"{where}.offset is {arm:g} m, more than the beam's length, {beam.length:g} m; is its unit right?"
        if body.mass > 0 and max(body.inertia) > body.mass * beam.length**2:
            yield (
                f"{where}.inertia is up to {max(body.inertia):g} kg m^2, of {body.mass:g} kg as wide as "
                f"{np.sqrt(max(body.inertia) / body.mass):.3g} m; did you mean {max(body.inertia):g} kg mm^2?"
            )


def _mass(beam: Beam) -> float:
    at = np.linspace(0, beam.length, 41)
    area: Any = beam.section.at(at).area
    return float(beam.material.density * np.mean(area) * beam.length)

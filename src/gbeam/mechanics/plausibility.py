"""Doubts about beams and answers before anything is computed: implausible and impossible values, missing directions."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from gbeam.arrays.namespace import holds_jax, is_traced
from gbeam.errors import InputError
from gbeam.guards.checks import implausible
from gbeam.mechanics.fields.products import quadratic
from gbeam.mechanics.models import TORSION
from gbeam.mechanics.structure import Structure
from gbeam.motion.protocol import Motion, implausible_values, times
from gbeam.structure.beam import Beam
from gbeam.structure.material import Material, Orthotropic
from gbeam.structure.section import KINDS

STOCKIEST, SLENDEREST = 5.0, 2e5  # length over radius of gyration; a rectangle's is 0.29 of its thickness
LEANEST, FATTEST = 1e-3, 30.0  # radius of gyration over the root of the area
HEAVIEST = 1e3  # mass of a body over the beam's
SLOW_SOUND, FAST_SOUND = 500.0, 3e4  # speed of sound in a solid denser than polymers, and in any, m/s
DENSE = 2300.0  # kg/m^3
WEAKEST, STRONGEST = 1e-5, 0.1  # yield strength over Young's modulus of a solid stiffer than rubber
STIFF = 1e9  # Pa
LIMPEST, STIFFEST = 3e-3, 3.0  # shear modulus over Young's, of composites too

_UNITS = "are their units right?"
DISPARATE = 1e9  # of two sizes: of the smaller one's sixteen digits so many are lost in a sum


def implausible_beam(beam: Beam, bends: tuple[bool, bool]) -> tuple[str, ...]:
    """Warn, in the scenario's names, of what is implausible in a beam that `bends` along y and z; not under JAX."""
    if _traced(beam) or beam.material is None:
        return ()
    values = (*_material(beam), *_dimensions(beam))
    # A wrong unit makes ratios wrong as well: they are looked at where each value is plausible.
    return (*(values or (*_matching(beam), *_proportions(beam, bends))), *_bodies(beam))


def refuse_disparate(beam: Beam) -> None:
    """Raise InputError where a body or a spring is so much larger or smaller than the beam that a sum
    loses its digits.
    """
    if _traced(beam) or holds_jax(list(beam.root.springs.values()), [support.stiffness for support in beam.supports]):
        return
    for where, value, unit, quantity, ratio in _ratios(beam):
        if ratio > DISPARATE or (quantity == "stiffness" and ratio < 1 / DISPARATE):
            problem = f"is {value:g} {unit}: a {quantity} {ratio:.3g} times the beam's"
            raise InputError(where, problem, f"numbers hold both up to {DISPARATE:g} times; is its unit right?")


def refuse_unknown(beam: Beam, *, twist: bool, shear_y: bool, shear_z: bool) -> None:
    """Raise InputError if a stiffness or inertia is missing for strains that a model has."""
    if "rotation_x" in beam.root.springs and not beam.rotary_inertia:
        fix = "set it to true: a beam that turns about its axis has no other inertia"
        raise InputError("rotary_inertia", "is false, and the root gives way about x", fix)
    if beam.material is None or not (twist or shear_y or shear_z):
        return
    material, section = beam.material, beam.section
    if material.shear_modulus is None and material.poissons_ratio is None:
        fix = "give it, or poissons_ratio of an isotropic material"
        raise InputError("material.shear_modulus", "is missing, and the model has twist or shear", fix)
    if twist and "torsion_constant" not in section.dimensions and section.shape == "general":
        fix = "give J of the torque G J α', or modes.twist = 0"
        raise InputError("section.torsion_constant", "is missing, and the model has twist", fix)
    for axis, needed in (("y", shear_y), ("z", shear_z)):
        name = f"shear_coefficient_{axis}"
        if needed and name not in section.dimensions and section.shape == "general":
            fix = f"give k of the shear force k G A γ, or modes.shear_{axis} = 0"
            raise InputError(f"section.{name}", "is missing, and the model has shear", fix)
    if twist and not beam.rotary_inertia:
        fix = "set it to true: a beam that twists has no other inertia"
        raise InputError("rotary_inertia", "is false, and the model has twist", fix)


def _ratios(beam: Beam) -> Iterator[tuple[str, float, str, str, float]]:
    """Yield by body and spring: scenario key, value, unit, the quantity that it adds, and its ratio to the beam's."""
    mass, length, inertia = _mass(beam), beam.length, "moment of inertia"
    for i, body in enumerate(beam.masses):
        scale, arm, largest = mass * length**2, max(map(abs, body.offset)), max(body.inertia)
        yield f"masses[{i}].mass", body.mass, "kg", "mass", body.mass / mass
        yield f"masses[{i}].inertia", largest, "kg m^2", inertia, largest / scale
        yield f"masses[{i}].offset", arm, "m", inertia, body.mass * arm**2 / scale
    rigidities = beam.rigidities(np.asarray(beam.section.stations or (0.0,)))
    axial, about_y, about_z = (np.mean(rigidity) for rigidity in rigidities)
    bending = np.sqrt(about_y * about_z) / length
    springs = [(f"root.{name}", name, value) for name, value in beam.root.springs.items() if value]
    for i, support in enumerate(beam.supports):
        springs += [(f"supports[{i}].stiffness.{name}", name, value) for name, value in support.stiffness.items()]
    for where, name, value in springs:
        unit, stiffness = "N/m", bending / length**2
        if name.startswith("r"):
            unit, stiffness = "N m/rad", bending
        elif name in ("translation_x", "x"):
            stiffness = axial / length
        yield where, value, unit, "stiffness", float(value / stiffness)


def _traced(beam: Beam) -> bool:
    """True if JAX has values of the beam, its bodies, material or section."""
    bodies = [(body.mass, body.inertia, body.offset) for body in beam.masses]
    material = [] if beam.material is None else [*vars(beam.material).values()]
    values = beam.length, material, [*beam.section.dimensions.values()], beam.damping_ratio
    return holds_jax(*values, bodies)


def implausible_material(where: str, material: Material | Orthotropic) -> Iterator[str]:
    """Warn of values that no solid has."""
    yield from implausible(f"{where}.density", "density", material.density)
    if isinstance(material, Orthotropic):
        for i, modulus in enumerate(material.youngs_moduli):
            yield from implausible(f"{where}.youngs_moduli[{i}]", "modulus", modulus)
        return
    yield from implausible(f"{where}.youngs_modulus", "modulus", material.youngs_modulus)
    if material.yield_strength is not None:
        yield from implausible(f"{where}.yield_strength", "strength", material.yield_strength)


def _material(beam: Beam) -> Iterator[str]:
    """Values of the material, or the damping, that no solid has."""
    yield from implausible_material("beam.material", beam.metal)
    if beam.damping_ratio is not None:
        yield from implausible("beam.damping_ratio", "damping", float(np.max(beam.damping_ratio)))


def _dimensions(beam: Beam) -> Iterator[str]:
    """Warn of implausible lengths of the beam and of its section, and of sections larger than the beam's length."""
    yield from implausible("beam.length", "length", beam.length)
    for name, values in beam.section.dimensions.items():
        largest, kind = max(values), KINDS.get(name, "section")
        key = f"beam.section.{name}"
        doubts = implausible(key, kind, largest) or implausible(key, kind, min(values))
        yield from doubts
        if not doubts and kind == "section" and largest > beam.length:
            yield (
                f"beam.section.{name} is {largest:g} m, more than the beam's length, {beam.length:g} m; "
                + (f"did you mean {largest:g} mm?" if 3e-3 * largest < beam.length else "are their units right?")
            )


def _matching(beam: Beam) -> Iterator[str]:
    """Warn of properties of a material that are plausible alone and not together, such as modulus and density."""
    material = beam.metal
    modulus, density = float(material.youngs_modulus), float(material.density)
    speed = float(np.sqrt(modulus / density))
    soft = density > DENSE and speed < SLOW_SOUND
    if soft or speed > FAST_SOUND:
        advice = (
            f"did you mean {modulus / 1e6:g} GPa?" if soft and SLOW_SOUND < speed * 1e3**0.5 < FAST_SOUND else _UNITS
        )
        yield (
            f"beam.material.youngs_modulus is {modulus / 1e6:g} MPa, of {density:g} kg/m^3, so that sound travels at "
            f"{speed:.3g} m/s: nothing as {'dense is as soft' if soft else 'light is as stiff'}; {advice}"
        )
    limits = (
        ("yield_strength", material.yield_strength, WEAKEST, STRONGEST, modulus > STIFF),
        ("shear_modulus", material.shear_modulus, LIMPEST, STIFFEST, True),
    )
    for name, value, low, high, judged in limits:
        if value is not None and judged and not soft and not low < value / modulus < high:
            ratio = f"{value / modulus:.3g} times youngs_modulus, {modulus / 1e6:g} MPa"
            yield f"beam.material.{name} is {value / 1e6:g} MPa, {ratio}; {_UNITS}"


def _proportions(beam: Beam, bends: tuple[bool, bool]) -> Iterator[str]:
    """Warn of radii of gyration that do not fit the area or, in directions in which the beam bends, its length."""
    section = beam.section.at(np.asarray(beam.section.stations or (0.0,)))
    directions = (("y", bends[0], section.inertia_z, "z"), ("z", bends[1], section.inertia_y, "y"))
    for axis, bent, inertia, name in directions:
        gyration = np.sqrt(inertia / section.area)
        shape = gyration / np.sqrt(section.area)
        if not (shape.min() > LEANEST and shape.max() < FATTEST):
            yield (
                f"beam.section.inertia_{name} and area make a radius of gyration of {gyration.max():g} m in an area of "
                f"{section.area.max():g} m^2; are their units right?"
            )
        elif bent and not STOCKIEST < beam.length / gyration.max() < SLENDEREST:
            ratio = beam.length / gyration.max()
            why = "no beam is as stout" if ratio < STOCKIEST else "nothing as slender carries its own weight"
            yield (
                f"beam.length, {beam.length:g} m, is {ratio:.3g} times the section's radius of gyration along {axis}, "
                f"{gyration.max():.3g} m: {why}; are the units of length and section right?"
            )


def _bodies(beam: Beam) -> Iterator[str]:
    """Warn of bodies that are too heavy, too far off the axis or too wide beside the beam."""
    mass = _mass(beam)
    for i, body in enumerate(beam.masses):
        where = f"beam.masses[{i}]"
        if body.mass > HEAVIEST * mass:
            times = f"{body.mass / mass:.3g} times the beam's"
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
    """Mass of the beam without its bodies, kg, about."""
    area: Any = beam.section.at(np.linspace(0, beam.length, 41)).area
    return float(beam.density * np.mean(area) * beam.length)


BENT = 0.02  # of the length: from there on the places, linear in the coordinates, are wrong by one in a hundred
NEGLIGIBLE = 1e-9  # of the stiffness: what is less is rounding of a motion at rest
NOTICED = 0.01  # of the largest: a smaller share along a direction without shapes is none
STIFFER = 10.0  # times the other direction: from there on the driven one should be meant
SLOWEST, FASTEST = 1e-3, 1e6  # Hz, of a beam's lowest natural frequency


def input_warnings(
    structure: Structure,
    motion: Motion | None = None,
    *,
    name: str = "",
    span: tuple[float, float] = (0.0, 0.0),
    base: Any = None,
    rest: Any = None,
) -> tuple[str, ...]:
    """Warn of what is implausible in a structure and its motion over a `span` of time, s. Nothing is judged under JAX.

    The motion of the `base` at some times, and the circular frequencies at `rest` (n,), rad/s, are computed unless
    given.
    """
    if structure.traced or holds_jax(motion):
        return ()
    where = f"motion.{name}" if name else "motion"
    warnings = [*structure.warnings]
    if structure.size:
        lowest = float((structure.rest[0] if rest is None else rest)[0])
        warnings += _frequency(structure, lowest / (2 * np.pi))
    if motion is not None:
        warnings += implausible_values(motion, where, span, base)
        if base is None and motion.kind != "centrifuge" and not motion.free:
            base = motion.base(times(motion, span))
        elif base is None and motion.free:
            base = motion.mount.base(*np.zeros((3, 1)))  # type: ignore[attr-defined]
    warnings += unstiffened(structure, base, where)
    warnings += _warn_of_missing_shapes(structure, base, where, span)
    return (*warnings, *_twisting(structure, span), *_warn_of_edgewise_bending(structure, motion, base, where))


def _frequency(structure: Structure, lowest: float) -> Iterator[str]:
    """Lowest frequency, Hz, that no beam has, unless other warnings say why."""
    if not structure.warnings and not SLOWEST <= lowest <= FASTEST:
        yield (
            f"the beam's lowest natural frequency at rest is {lowest:.3g} Hz, outside the plausible {SLOWEST:g} to "
            f"{FASTEST:g} Hz; are the units of length, section and material right?"
        )


def unstiffened(structure: Structure, base: Any, where: str) -> Iterator[str]:
    """Warn if the loads of a motion would noticeably stiffen a structure whose matrices leave that out.

    An acceleration a bends a cantilever by about a/ω². The stress changes the square of its lowest frequency by about
    a/(ω² L) of itself; a rotation changes it by about Ω²/ω².
    """
    if not structure.unstiffened or base is None or is_traced(base.a_WO_B):
        return
    length, square = float(structure.length), float(structure.rest[0][0]) ** 2
    vectors = base.a_WO_B, base.w_WB_B, base.alpha_WB_B
    a, w, alpha = (np.linalg.norm(np.reshape(vector, (-1, 3)), axis=-1) for vector in vectors)
    share = float((a / length + w**2 + alpha).max()) / square
    if share > NEGLIGIBLE:
        yield (
            f"{where} loads the body so that the stiffness that is left out changes the square of its lowest "
            f"frequency by the order of {100 * share:.2g} %"
        )


def bend(structure: Structure, q: Any) -> float:
    """Largest displacement of a station at coordinates (..., n), as a share of the length, or zero of a beam.

    It is of structures whose places are linear in the coordinates.
    """
    if structure.field is not None or not structure.size:
        return 0.0
    return float(np.linalg.norm(structure.displacement(q), axis=-1).max() / structure.length)


def elastic_bend(structure: Structure, base: Any) -> float:
    """Return the :func:`bend` of the static answer to a motion of the base (..., 3), by the elastic stiffness alone."""
    if structure.field is not None:
        return 0.0
    c = structure.coefficients
    _, _, force = c.evaluate(base.a_WO_B, base.w_WB_B, base.alpha_WB_B)
    return bend(structure, np.linalg.solve(c.stiffness, force[..., None])[..., 0])


def first_order_clause(share: float) -> str:
    """Clause on a bend, as a share of the length, that is too far for a stiffness of first order; else ""."""
    if share < BENT:
        return ""
    return f"it bends by {100 * share:.2g} % of its length, and its stiffness is of first order in that"


def bent_far(structure: Structure, share: float) -> Iterator[str]:
    """Warn of a bend, as a share of the length, that is too far for a stiffness of first order."""
    if clause := first_order_clause(share):
        yield f"{clause}: {_left_out(structure)}"


def _left_out(structure: Structure) -> str:
    """Clause on what a stiffness of first order leaves out."""
    is_known = structure.richer is not None and structure.richer.bending is not None
    return f"what that leaves out is {'stated as error of the model' if is_known else 'not known'}"


def stretched(structure: Structure, q: Any) -> Iterator[str]:
    """Warn of a mesh that its supports stretch where it bends, by coordinates (..., n).

    What is held takes up R(q), of second degree. With the stiffness L of what is held, the stretch has the energy
    R L⁻¹ R/2 and adds the share 4 U(q)/(q K q) to the elastic forces.
    """
    grip = structure.grip
    if grip is None or grip.second is None:
        return
    dependents, c = np.array(grip.dependents), structure.coefficients
    coordinates = np.reshape(q, (-1, structure.size))
    reactions = quadratic(grip.second, coordinates @ grip.basis.T)
    flexibility = np.linalg.pinv(grip.free.coefficients.stiffness[np.ix_(dependents, dependents)], hermitian=True)
    stretch = np.einsum("tj,jk,tk->t", reactions, flexibility, reactions) / 2
    energy = 4 * stretch.max() / max(float((coordinates @ c.stiffness * coordinates).sum(axis=1).max()), 1e-300)
    if energy > NOTICED:
        yield (
            f"its supports stretch it where it bends, which stiffens it by the order of {100 * energy:.2g} %: "
            f"{_left_out(structure)}"
        )


def _warn_of_missing_shapes(structure: Structure, base: Any, where: str, span: tuple[float, float]) -> Iterator[str]:
    """Warn of accelerations and loads across the beam along axes without shapes: the model stays straight there."""
    rigid_axes = structure.axes_without_shapes
    if structure.field is None or not rigid_axes:
        return
    if base is not None and not is_traced(base.a_WO_B):
        accelerations = np.abs(np.reshape(base.a_WO_B, (-1, 3))).max(axis=0)
        for axis in rigid_axes:
            if accelerations[axis] > NOTICED * accelerations.max():
                yield _remark(
                    f"{where} accelerates the root, or gravity does,", f"{accelerations[axis]:.3g} m/s²", axis
                )
    if structure.history is None:
        return
    values = _largest_loads(structure, span)
    for axis in rigid_axes:
        # A moment about z bends along y, one about y along z.
        for part, column, unit in (("force", axis, "N"), ("moment", 6 - axis, "N m")):
            largest = values[:, 3 * (column // 3) : 3 * (column // 3) + 3].max(initial=0.0)
            for i in np.flatnonzero(values[:, column] > NOTICED * largest):
                yield _remark(f"beam.loads[{i}].{part} bends the beam", f"{values[i, column]:.3g} {unit}", axis)


def _twisting(structure: Structure, span: tuple[float, float]) -> Iterator[str]:
    """Warn of moments about the beam's axis if the model does not twist."""
    if structure.field is None or structure.history is None or structure.counts[3]:
        return
    values = _largest_loads(structure, span)[:, 3:]
    for i in np.flatnonzero(values[:, 0] > NOTICED * values.max(initial=0.0)):
        yield (
            f"beam.loads[{i}].moment twists the beam about x with up to {values[i, 0]:.3g} N m, and "
            f"{structure.kind} does not turn by it: {TORSION}"
        )


def _warn_of_edgewise_bending(structure: Structure, motion: Any, base: Any, where: str) -> Iterator[str]:
    """Warn if a hub's angular acceleration bends a beam in its stiff direction and the setting angle was not chosen."""
    if motion is None or motion.kind != "hub" or structure.source is None:
        return
    if motion.setting_angle is not None or motion.turn is not None:
        return
    if not (motion.free or (base is not None and np.any(base.alpha_WB_B))):
        return
    beam = structure.source.beam
    _, bending_z, bending_y = (np.mean(values) for values in beam.rigidities(np.linspace(0, beam.length, 41)))
    if bending_y > STIFFER * bending_z:
        yield (
            f"{where} bends the beam along y, in its plane of rotation, where it is {bending_y / bending_z:.3g} times "
            f'as stiff as along z; give {where}.setting_angle = "90 deg" to turn it, or "0 deg" if this is meant'
        )


def _largest_loads(structure: Structure, span: tuple[float, float]) -> Any:
    """Largest sizes of the components of each load over a span of time, (loads, 6), without its temperature."""
    history: Any = structure.history
    if structure.heated:
        history = replace(history, profiles=history.profiles[:-1])
    if not history.profiles:
        return np.zeros((0, 6))
    corners = np.clip(history.corners((span[1] - span[0]) / 200), *span)
    samples = np.union1d(np.linspace(*span, 201), corners)
    return np.abs(history(samples)).max(axis=0)


def _remark(quantity: str, size: str, axis: int) -> str:
    """Warning that `quantity` acts along an axis for which the model has no shapes."""
    way = "xyz"[axis]
    return (
        f"{quantity} along {way} with up to {size}, where the model has no shapes: the beam stays straight there; "
        f"give model.modes.{way} = 1 or more"
    )

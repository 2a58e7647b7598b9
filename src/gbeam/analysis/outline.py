"""Outlines of beams and systems at rest, for pictures of what they do, and the ends of what they take up."""

from __future__ import annotations

from dataclasses import astuple
from typing import Any

import numpy as np

from gbeam.arrays.types import Complex, Floats, Indices
from gbeam.mechanics.fields.taylor import Places
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.tree.joints import GROUND
from gbeam.mechanics.tree.rigid_body import RigidBody
from gbeam.mechanics.tree.system import System
from gbeam.motion.flight import Flight
from gbeam.motion.protocol import Motion
from gbeam.numerics.samples import attitude
from gbeam.results.parts import Outline, Supports
from gbeam.results.solids import Surface, SurfaceModes
from gbeam.results.system import Assembly
from gbeam.structure.supports import Label


def assembly_of(system: System) -> Assembly:
    """Describe the joints of a system, and boxes that have the mass and the inertia of its rigid bodies."""
    holding = {joint.body: joint for joint in system.joints.values()}
    boxes = [_box(system.bodies[name]) for name in system.order]
    size, centre, rotation = (np.stack(parts) for parts in zip(*boxes, strict=True))
    return Assembly(
        bodies=system.order,
        hangs_on=tuple(holding[name].on for name in system.order),
        joint=tuple(holding[name].kind for name in system.order),
        place_at_rest=np.stack([_place_at_rest(system, holding[name].on) for name in system.order]),
        undeformed=system.undeformed,
        box=size,
        box_centre=centre,
        box_rotation=rotation,
    )


def ends_of(system: System) -> dict[str, Floats]:
    """Places (3,) m, by name, at one of which the load on the undeformed bodies is largest.

    They are the corners of convex hulls. Ends of beams, and bodies off their axes; points and centres of mass of rigid
    bodies; and points of matrices.
    """
    several, ends = len(system.bodies) > 1, dict[str, Floats]()
    for name, root in zip(system.order, system.start_state.roots, strict=True):
        for end, place in _ends(system.bodies[name]).items():
            ends[f"{end} of {name}" if several else end] = np.asarray(root.p + root.R @ place)
    return ends


def _ends(body: RigidBody | Structure) -> dict[str, Floats]:
    """Places (3,) m, by name, at one of which the load on an undeformed body is largest, from its root in its axes."""
    root = {"the root": np.zeros(3)}
    if isinstance(body, RigidBody):
        points = {f"the point {name}": np.asarray(point.at, dtype=float) for name, point in body.points.items()}
        return root | points | {"the centre of mass": np.asarray(body.centre, dtype=float)}
    beam = None if body.source is None else body.source.beam
    envelope = np.empty((0, 3)) if beam is None else beam.envelope
    hull = envelope if body.recovery is None else body.recovery.envelope
    if len(hull):
        return {"({:.4g}, {:.4g}, {:.4g}) mm".format(*(1e3 * corner)): corner for corner in hull}
    if beam is None:
        names = body.points or tuple(f"point {k + 1}" for k in range(len(body.stations)))
        return root | dict(zip(names, np.asarray(body.station_places.r0), strict=True))
    ends = root | {"the tip": np.array([beam.length, 0.0, 0.0])}
    for centre in beam.body_centres:
        if np.any(centre[1:] != 0) or not 0 <= centre[0] <= beam.length:  # off the axis
            ends[f"the body at {1e3 * centre[0]:.4g} mm"] = centre
    return ends


def _place_at_rest(system: System, on: str) -> Floats:
    """Place (3,) m of a point from the root of its undeformed body, or zero for the origin of the ground."""
    if on == GROUND:
        return np.zeros(3)
    name, point = system.point("on", on)
    link = system.tree.links[system.order.index(name)]
    zeros = np.zeros(link.body.size)
    places = [relative.r for relative in link.body.relative(zeros, zeros, zeros)]
    return np.asarray(places[point]) if point < len(places) else np.zeros(3)


def _box(body: object) -> tuple[Floats, Floats, Floats]:
    """Extents, centre and rotation of a uniform box with the inertia of a rigid body, or NaN for other bodies."""
    if not isinstance(body, RigidBody):
        return np.full(3, np.nan), np.full(3, np.nan), np.full((3, 3), np.nan)
    moments, axes = np.linalg.eigh(body.tensor)
    axes[:, 2] *= np.linalg.det(axes)
    # Of edges a, b, c the box has I_x = m (b² + c²)/12 and so on: a² = 6 (tr I − 2 I_x)/m.
    squares = 6 * (moments.sum() - 2 * moments) / body.mass if body.mass > 0 else 0 * moments
    return np.sqrt(np.maximum(squares, 0.0)), np.asarray(body.centre, dtype=float), axes


POINTS = 16  # along a straight beam, at most; twice as many along a line
OF_MODES = 65  # of the shapes of modes, likewise
TIMES = 1500
# Triangles of a box whose corners are at the low and high ends of x, y and z, z the first to change.
BOX = np.array(
    [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1), (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4),
     (1, 5, 7), (1, 7, 3)]
)  # fmt: skip


def outline_of(
    structure: Structure, motion: Motion | None, time: Floats, q: Floats, count: int = POINTS
) -> Outline | None:
    """Outline of a beam at times (t,) with coordinates `q` (t, n), at `count` points, with hub and attitude of a
    motion. None if the structure is no beam.
    """
    if structure.field is None or structure.sections is None or structure.source is None:
        return None
    beam, chosen = structure.source.beam, _chosen(structure, count)
    outline = structure.field.points(slice(None))[chosen]
    sampled = _sampled(time)
    rest = structure.sections.along[chosen]
    moved = np.asarray(outline.positions(q[sampled]) - outline.positions(np.zeros(structure.size)))
    points = np.concatenate([[0.0], rest])
    section = beam.section.at(points)
    width, thickness = section.extents()
    place, axes = (None, None) if beam.line is None else beam.at_rest(points)
    return Outline(
        points=points,
        width=width,
        thickness=thickness,
        round=section.round,
        bodies=np.array([(body.at, body.mass) for body in beam.masses], dtype=float).reshape(-1, 2),
        time=time[sampled],
        displacement=_from_root(structure, rest, moved),
        place=place,
        across=None if axes is None else axes[:, :, 1],
        **_carrier(motion),
        attitude=_attitude(motion, time, sampled),
    )


def labels_of(structure: Structure) -> tuple[Label, ...]:
    """Names of the places at which a structure is held, and what holds them there."""
    if structure.source is not None:
        return tuple(support.label for support in structure.source.beam.supports)
    return () if structure.grip is None else structure.grip.labels


def supports_of(structure: Structure, outline: Outline | None, time: Floats, q: Floats) -> Supports | None:
    """Supports of a structure at times (t,) with coordinates `q` (t, n), or None without supports.

    They are where nothing else is: those of a beam move with its `outline`, and have the extents of its section.
    """
    labels, grip = labels_of(structure), structure.grip
    if not labels:
        return None
    name, words, rigid, yielding = zip(*map(astuple, labels), strict=True)
    if outline is None:
        assert grip is not None and grip.places is not None
        sampled = _sampled(time)
        place, extents = np.asarray(grip.places.r0), np.zeros((len(labels), 3))
        moved = np.asarray(grip.places.positions(q[sampled] @ grip.basis.T))
        position, time, displacement = place[:, 0], time[sampled], moved - place
    else:
        position = _positions_held(structure)
        straight = outline.points[:, None] * np.eye(3)[0]
        place = _on_outline(outline, straight if outline.place is None else outline.place, position)
        sections = np.stack([np.zeros(len(outline.points)), outline.width, outline.thickness], axis=1)
        extents = _on_outline(outline, sections, position)
        time, displacement = outline.time, _on_outline(outline, outline.displacement, position)
    return Supports(name, position, place, extents, words, rigid, yielding, time, displacement)


def supports_in_modes(structure: Structure, q: Floats, modes: Complex, shapes: dict[str, Any]) -> dict[str, Any]:
    """Supports of a structure at coordinates (n,), and the displacement (k, h, 3) of their places in modes (n, k), by
    the names of fields. Those of a beam move with the `shapes` of its outline. Empty without supports.
    """
    outline, grip = shapes.get("outline"), structure.grip
    supports = supports_of(structure, outline, np.zeros(1), q[None])
    if supports is None:
        return {}
    if outline is None:
        assert grip is not None and grip.places is not None
        shape = np.moveaxis(grip.places.slopes(q @ grip.basis.T) @ (grip.basis @ modes), -1, 0)
    else:
        shape = _on_outline(outline, shapes["outline_shape"], supports.position)
    return {"supports": supports, "support_shape": shape}


def box_of(structure: Structure, time: Floats, q: Floats) -> dict[str, Surface]:
    """Surface of the box around a rigid body on supports at times (t,) with coordinates `q` (t, n), by the name of its
    field. Empty for other bodies.
    """
    grip = structure.grip
    if grip is None or grip.free.corners is None:
        return {}
    sampled = _sampled(time)
    return {"surface": Surface(**_box_skin(grip.free.corners), time=time[sampled], sizes=q[sampled] @ grip.basis.T)}


def box_in_modes(structure: Structure, modes: Complex) -> SurfaceModes | None:
    """Surface of the box around a rigid body on supports in modes (n, k), or None for other bodies."""
    grip = structure.grip
    if grip is None or grip.free.corners is None:
        return None
    return SurfaceModes(**_box_skin(grip.free.corners), sizes=(grip.basis @ modes).T)


def _box_skin(corners: Places) -> dict[str, Any]:
    """Fields of the surface of a box with corners (8,), which moves by their slopes and has no stress."""
    shapes = np.moveaxis(np.asarray(corners.first), -1, 0)
    return {
        "vertices": np.asarray(corners.r0),
        "triangles": BOX,
        "shapes": shapes,
        "stress": np.zeros((*shapes.shape[:2], 6)),
        "judged": np.zeros(len(corners.r0), dtype=bool),
    }


def _positions_held(structure: Any) -> Floats:
    """Positions (h,) m of a beam's supports, from the root."""
    return np.array([support.place for support in structure.source.beam.supports], dtype=float)


def _on_outline(outline: Outline, values: Any, positions: Floats) -> Any:
    """Values (..., h, 3) at positions (h,) m along a beam, linearly between those (..., p, 3) of its outline."""
    last = len(outline.points) - 2
    before = np.clip(np.searchsorted(outline.points, positions, side="right") - 1, 0, last)
    share = ((positions - outline.points[before]) / np.diff(outline.points)[before])[:, None]
    return (1 - share) * values[..., before, :] + share * values[..., before + 1, :]


def _sampled(time: Floats) -> Indices:
    """Indices of the times at which pictures are drawn."""
    return np.unique(np.linspace(0, len(time) - 1, TIMES).round().astype(int))


def _chosen(structure: Any, count: int) -> Any:
    """Indices of `count` points of a beam's field, evenly spread along it."""
    beam, sections = structure.source.beam, structure.sections
    x, index = np.unique(np.round(sections.along / beam.length, 9), return_index=True)
    count = count if beam.line is None else 2 * count
    return index[np.unique(np.linspace(0, len(x) - 1, count - 1).round().astype(int))]


def _from_root(structure: Any, rest: Floats, moved: Any) -> Any:
    """Prepend the values of a beam's root to those (t, p, ...) at positions `rest` (p,) m along it: (t, p + 1, ...)."""
    # The field has no point at the root: the nodes next to it lie within a hundredth of the length.
    root = moved[:, 0] - (moved[:, 1] - moved[:, 0]) * (rest[0] / (rest[1] - rest[0]))
    if not structure.source.beam.root.springs:
        root = np.zeros_like(root)
    return np.concatenate([root[:, None], moved], axis=1)


def outline_in_modes(structure: Structure, q: Floats, modes: Complex) -> dict[str, Any]:
    """Outline of a beam at coordinates (n,), and the displacement (k, p, 3) and twist (k, p) of its points in modes (n,
    k), by the names of fields. Empty if the structure is no beam.
    """
    outline = outline_of(structure, None, np.zeros(1), q[None], OF_MODES)
    if outline is None or structure.field is None:
        return {}
    chosen, rest = _chosen(structure, OF_MODES), outline.points[1:]
    shape = np.moveaxis(structure.field.points(slice(None))[chosen].slopes(q) @ modes, -1, 0)
    twist = structure.twist_slopes(q, chosen)
    return {
        "outline": outline,
        "outline_shape": _from_root(structure, rest, shape),
        "outline_twist": None if twist is None else _from_root(structure, rest, (twist @ modes).T),
    }


def _attitude(motion: Any, time: Floats, sampled: Any) -> Floats | None:
    """Attitude of a flight at sampled times. Its rates are integrated over all times, or None if it has none."""
    if not isinstance(motion, Flight) or motion.rates is None:
        return None
    return attitude(time, np.asarray(motion.base(time).w_WB_B))[sampled]


def _carrier(motion: Any) -> dict[str, Any]:
    """Radius and orientation of the hub or arm that carries a beam, and its root's place on an arm; or nothing."""
    if motion is None or motion.kind != "hub":
        return {}
    place = np.asarray(motion.mount.place)
    of_arm = {"arm_root": place} if motion.name == "arm" else {}
    return {"radius": float(place[0]), "R_HB": np.asarray(motion.mount.R_HB), **of_arm}

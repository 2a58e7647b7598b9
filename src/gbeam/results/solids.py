"""Stress of a solid over time, and the loads of a rigid specimen."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from gbeam.arrays.types import Numbers
from gbeam.constants import STANDARD_GRAVITY
from gbeam.errors import InputError
from gbeam.guards.checks import index_of, vector
from gbeam.results.declared import along_time, declared, fact, internal, labels, part, quantity
from gbeam.results.parts import LoadPeaks, margin_words, yield_margin
from gbeam.results.result import Complex, Figured, Flags, Floats, Part

UNLIMITED = "at sharp edges and the edges of clamps the stress of an elastic solid has no limit as the mesh gets finer"
NOT_KNOWN = f"{UNLIMITED}: one mesh does not tell whether the largest is there; give a coarser one beside it"


@dataclass(frozen=True, repr=False, eq=False)
class StressAt(Part):
    """Stress at a node and a time."""

    von_mises: float = quantity("Pa", "von Mises stress")
    principal: Floats = quantity("Pa", "principal stresses, the largest first", "principal")
    time: float = quantity("s", "its time")
    place: Floats = quantity("m", "place of the node from the root, undeformed", "axis")
    node: int = quantity("", "number of the node in the mesh's file, or from 1 in its order where it has none")
    material: str = quantity("", "name of the material")
    spread: float = quantity("", "how much the elements that share the node differ, as a fraction",
                             note="an indication of the mesh's error there")  # fmt: skip
    yield_strength: float | None = quantity("Pa", "yield strength of the material", optional=True, default=None)

    @declared("", "yield strength over von Mises stress less one", optional=True)
    def margin(self) -> float | None:
        """Margin on yield, or None where the strength is not known."""
        if self.yield_strength is None:
            return None
        return float(yield_margin(self.yield_strength, np.array(self.von_mises)))

    @property
    def spread_words(self) -> str:
        """Difference of the elements that share the node, in words."""
        return (
            f"; elements there differ by {float(f'{100 * self.spread:.2g}'):g} %" if self.spread else ", of one element"
        )


@dataclass(frozen=True, repr=False, eq=False)
class SolidStress(Figured[Literal["stress"]]):
    """Stress of a solid in a response: anywhere, at its named points, and where it is worst.

    Stresses are those of the coordinates, which hold the static answer to the base's motion, at the nodes: extrapolated
    from the elements' best points and averaged over the elements of the same material.
    """

    json_rows: ClassVar[dict[str, str]] = {"point": "points"}

    motion: str = fact("name of the motion")
    model: str = fact("kind of the model")
    time: Floats = quantity("s", "time", "time", role="coordinate")
    von_mises: Floats = quantity("Pa", "largest von Mises stress in the solid at that time", "time")
    worst: StressAt = part("where the von Mises stress is largest", name="worst_")
    nearest_yield: StressAt | None = part(
        "where the margin on yield is least", name="nearest_yield_", optional=True, default=None
    )
    singular: StressAt | None = part("of nodes that are left out the largest", name="singular_", optional=True,
                                     note=UNLIMITED, default=None)  # fmt: skip
    singular_nodes: int | None = fact("number of nodes that are left out; not known of one mesh", note=UNLIMITED,
                                      optional=True, default=None)  # fmt: skip
    known: bool = fact(
        "whether the largest stress is known", note="not where more than a tenth of the nodes is left out", default=True
    )
    singular_depth: float = fact("largest distance of a node that is left out to one that is judged", "m", default=0.0)
    points: tuple[str, ...] = labels("name of the point", "point", default=())
    point_von_mises: Floats = quantity("Pa", "von Mises stress at the point", "time point", empty=True)
    point_principal: Floats = quantity(
        "Pa", "principal stresses at the point, the largest first", "time point principal", empty=True
    )
    materials: tuple[str, ...] = internal("", "name of the material", "material", default=())
    exponents: Floats = internal("", "exponent of its Wöhler curve", "material", empty=True)
    material_normal: Floats = internal(
        "Pa",
        "normal stress where it is stressed most, on the plane where that ranges most",
        "time material",
        empty=True,
    )
    point_normal: Floats = quantity(
        "Pa", "normal stress at the point, on the plane where it ranges most", "time point", empty=True
    )
    point_exponent: Floats = internal("", "exponent of the Wöhler curve of the material there", "point", empty=True)
    point_stress: Floats = quantity(
        "Pa",
        "stress xx, yy, zz, yz, xz, xy at the point",
        "time point stress_component",
        frame="axes of the point",
        empty=True,
    )
    point_strain: Floats = quantity(
        "",
        "strain xx, yy, zz, yz, xz, xy at the point, with twice the tensor's shear",
        "time point stress_component",
        frame="axes of the point",
        empty=True,
    )
    nodes: Floats = quantity(
        "m", "places of the nodes from the root, undeformed", "node axis", name="node_place", key=None, empty=True
    )
    node_von_mises: Floats = quantity(
        "Pa", "largest von Mises stress over time at the node", "node", key=None, empty=True
    )

    point_peaks: Floats | None = internal(
        "", "at the points: largest von Mises stress Pa, its time s, and largest strain", "peak point", default=None
    )

    def sampled(self, steps: Any) -> SolidStress:
        """Return the histories at some of the steps, with the peaks of all."""
        peaks = np.stack([self.point_max, self.point_time_of_max, self.point_strain_max])
        histories = {name: values[steps] for name, values in along_time(self).items() if len(values)}
        return replace(self, **histories, point_peaks=peaks)

    @declared("", "what is left out of the largest stress, and why, or why that is not known", role="fact")
    def left_out(self) -> str:
        if not self.known:
            return (
                f"the largest stress is not known: {UNLIMITED}, and {self.singular_nodes} of {len(self.nodes)} nodes "
                "are there, more than a tenth; mesh it finer, or read the stress at a point"
            )
        if self.singular is None:
            return NOT_KNOWN if self.singular_nodes is None else ""
        return (
            f"{UNLIMITED}: {self.singular_nodes} nodes, up to "
            f"{1e3 * self.singular_depth:.3g} mm from the others, are left out, the "
            f"largest {stress_words(self.singular)}"
        )

    @declared("Pa", "normal stress at the worst place, on the plane where it ranges most", "time", name="worst_normal")
    def normal(self) -> Floats:
        return self.material_normal[:, self.materials.index(self.worst.material)]

    @declared("Pa", "largest von Mises stress", "point", name=None, key="von_mises")
    def point_max(self) -> Floats:
        return self.point_von_mises.max(axis=0) if self.point_peaks is None else self.point_peaks[0]

    @declared("s", "time of that stress", "point", name=None, key="time_of_max")
    def point_time_of_max(self) -> Floats:
        return self.time[self.point_von_mises.argmax(axis=0)] if self.point_peaks is None else self.point_peaks[1]

    @declared("", "largest size of the normal strain along x of the point's axes", "point", name=None, key="strain")
    def point_strain_max(self) -> Floats:
        return np.abs(self.point_strain[..., 0]).max(axis=0) if self.point_peaks is None else self.point_peaks[2]

    def strain_at(self, point: str, along: Numbers = (1.0, 0.0, 0.0)) -> Floats:
        """Return what a strain gauge at a named point reads, (t,), as :meth:`gbeam.Response.strain_at` does."""
        station = index_of("point", point, self.points)
        direction = np.asarray(vector("along", along), dtype=float)
        if not direction.any():
            raise InputError("along", "is zero", "give a direction, such as (1, 0, 0)")
        x, y, z = direction / np.linalg.norm(direction)
        strain = self.point_strain[:, station]
        return np.asarray(strain @ np.array([x * x, y * y, z * z, y * z, x * z, x * y]))

    @property
    def lines(self) -> tuple[str, str]:
        """The largest stress and the least margin in words."""
        if not self.known:
            return "the largest stress is not known", "margin on yield not known"
        if self.nearest_yield is None:
            return stress_words(self.worst), "margin on yield not known: no material has a yield_strength"
        assert self.nearest_yield.margin is not None
        words = margin_words(self.nearest_yield.margin)
        material = self.nearest_yield.material or "the material"
        same_node = (self.worst.node, self.worst.material) == (self.nearest_yield.node, self.nearest_yield.material)
        place = ", there" if same_node else f": {stress_words(self.nearest_yield)}"
        return stress_words(self.worst), f"{words} in {material}{place}"

    def __repr__(self) -> str:
        motion = f" {self.motion!r}" if self.motion else ""
        worst, margin = self.lines
        lines = [f"SolidStress{motion} ({self.model}): {worst}", margin]
        return self._with_warnings(*lines, *filter(None, [self.left_out]))


def von_mises(stress: Floats) -> Floats:
    """Von Mises stress of stresses xx, yy, zz, yz, xz, xy, (..., 6)."""
    xx, yy, zz, yz, xz, xy = np.moveaxis(stress, -1, 0)
    squares: Floats = ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) / 2 + 3 * (yz**2 + xz**2 + xy**2)
    return np.sqrt(squares)


def place_words(place: Floats) -> str:
    """A place (3,), m, in mm; rounded to the nanometre, so that a rounding error is zero."""
    x, y, z = 1e3 * np.round(np.asarray(place, dtype=float), 9) + 0.0
    return f"({x:.4g}, {y:.4g}, {z:.4g}) mm"


def stress_words(stress: StressAt) -> str:
    """A stress with its place and time, and the spread of the elements there."""
    return (
        f"von Mises {1e-6 * stress.von_mises:.4g} MPa at {place_words(stress.place)}, node {stress.node}, at "
        f"{stress.time:.4g} s{stress.spread_words}"
    )


@dataclass(frozen=True, repr=False, eq=False)
class Skin(Part):
    """Surface of a solid for pictures, coarser than its mesh, and a few shapes that move and stress it."""

    vertices: Floats = quantity("m", "place of the vertex from the root, undeformed", "vertex axis")
    triangles: NDArray[np.int_] = quantity("", "vertices of the triangle, from 0", "triangle corner_of_triangle")
    shapes: Floats = quantity("m", "displacement of the vertex", "surface_shape vertex axis")
    stress: Floats = quantity(
        "Pa", "stress xx, yy, zz, yz, xz, xy at the vertex", "surface_shape vertex stress_component"
    )
    judged: Flags = quantity("", "whether the largest stress counts the vertex", "vertex", note=UNLIMITED)


@dataclass(frozen=True, repr=False, eq=False)
class Surface(Skin):
    """Surface of a solid over time."""

    time: Floats = quantity("s", "some of the times", "surface_time", role="coordinate")
    sizes: Floats = quantity("", "size of the shape over time", "surface_time surface_shape")


@dataclass(frozen=True, repr=False, eq=False)
class SurfaceModes(Skin):
    """Surface of a solid in modes."""

    sizes: Complex = quantity("", "size of the shape, in the size of the mode's shape", "mode surface_shape")


@dataclass(frozen=True, repr=False, eq=False)
class CornerLoad(Part):
    """Largest load at a point of a specimen."""

    size: float = quantity("m/s^2", "largest size of the acceleration, or specific force where gravity acts")
    time: float = quantity("s", "its time")
    place: Floats = quantity("m", "place of the point from the root", "axis")

    @declared("", "that in units of standard gravity", name=None)
    def g(self) -> float:
        return self.size / STANDARD_GRAVITY


@dataclass(frozen=True, repr=False, eq=False)
class SpecimenLoads(Figured[Literal["specimen"]]):
    """Loads of a rigid specimen over time: at its corners, on its fixture and on every bolt."""

    json_rows: ClassVar[dict[str, str]] = {"bolt": "bolts", "corner": "corners"}

    motion: str = fact("name of the motion")
    environment: str = fact("flight, centrifuge, hub or arm")
    mass: float = fact("mass of the specimen", "kg")
    time: Floats = quantity("s", "time", "time", role="coordinate")
    corners: Floats = quantity(
        "m", "place of the corner from the root", "corner axis", name="corner_place", key="place"
    )
    acceleration: Floats = quantity(
        "m/s^2", "acceleration of the corner; specific force where gravity acts", "time corner axis"
    )
    centre: Floats = quantity(
        "m/s^2", "acceleration of the centre of mass, likewise", "time axis", name="centre_acceleration"
    )
    force: Floats = quantity("N", "force of the fixture on the specimen", "time axis")
    moment: Floats = quantity("N m", "moment of the fixture on the specimen about the root", "time axis")
    bolts: Floats = quantity(
        "m", "place of the bolt from the root", "bolt axis", name="bolt_place", key="place", empty=True
    )
    bolt_force: Floats = quantity("N", "force of the bolt on the specimen", "time bolt axis", empty=True)
    bolt_axis: Floats = quantity(
        "", "direction of the bolts", "axis", key=None, optional=True, default_factory=lambda: np.empty(0)
    )
    spread_limit: float | None = fact("largest spread that is accepted", optional=True, default=None)
    root: LoadPeaks | None = field(default=None, repr=False)  # peaks of force and moment between these times, if known

    @declared("", "whether the spread is within its limit", role="fact", name=None, optional=True)
    def within_limit(self) -> bool | None:
        """True if the spread is within its limit, or None without one, or where nothing accelerates."""
        spread, limit = self.spread_max, self.spread_limit
        return None if limit is None or np.isnan(spread) else bool(spread <= limit)

    @property
    def refusal(self) -> str:
        """The limit that is not kept, in words, or empty where it is, or there is none."""
        if self.within_limit is not False:
            return ""
        assert self.spread_limit is not None
        return f"spread {100 * self.spread_max:.3g} % over the specimen (limit {100 * self.spread_limit:.3g} %)"

    @declared("m/s^2", "largest size of the acceleration at the corner", "corner", name=None, key="max_abs")
    def corner_max(self) -> Floats:
        return np.linalg.norm(self.acceleration, axis=-1).max(axis=0)

    @declared("m/s^2", "largest size of the acceleration of the centre of mass", name=None, key="centre")
    def centre_max(self) -> float:
        return float(np.linalg.norm(self.centre, axis=-1).max())

    @declared("", "largest load at any corner", role="part", name="largest_", key="largest_load")
    def largest(self) -> CornerLoad:
        size = np.linalg.norm(self.acceleration, axis=-1)
        t, k = np.unravel_index(size.argmax(), size.shape)
        return CornerLoad(float(size[t, k]), float(self.time[t]), self.corners[k])

    @declared("", "largest difference of a corner's acceleration to the centre's, over the largest of the centre",
              name="spread_max", key="spread")  # fmt: skip
    def spread_max(self) -> float:
        return float(self.spread.max())

    @declared(
        "", "largest difference of a corner's acceleration to the centre's, over the largest of the centre", "time"
    )
    def spread(self) -> Floats:
        """Spread of the load over the specimen, (t,): NaN where nothing accelerates."""
        distance = np.linalg.norm(self.acceleration - self.centre[:, None], axis=-1).max(axis=1)
        largest = np.linalg.norm(self.centre, axis=-1).max()
        return distance / largest if largest > 0 else np.full(len(distance), np.nan)

    @declared("N", "largest size of the force on the specimen", name=None, key="force.max_abs")
    def force_max(self) -> float:
        peak = 0.0 if self.root is None else float(self.root.root_force.size.value)
        return max(float(np.linalg.norm(self.force, axis=-1).max()), peak)

    @declared("N m", "largest size of the moment on the specimen about the root", name=None, key="moment.max_abs")
    def moment_max(self) -> float:
        peak = 0.0 if self.root is None else float(self.root.root_moment.size.value)
        return max(float(np.linalg.norm(self.moment, axis=-1).max()), peak)

    @property
    def bolt_pull(self) -> Floats:
        """Force along the bolt, (t, b) N: tension, or negative where the specimen is pressed on the fixture."""
        # The bolt pulls the specimen against its axis, which points away from the fixture.
        return -(self.bolt_force @ self.bolt_axis) if len(self.bolts) else np.empty((len(self.time), 0))

    @declared("N", "tension of the bolt", "time bolt")
    def tension(self) -> Floats:
        return np.maximum(self.bolt_pull, 0.0)

    @declared("N", "force that presses the specimen on the fixture at the bolt", "time bolt")
    def compression(self) -> Floats:
        return np.maximum(-self.bolt_pull, 0.0)

    @declared("N", "shear of the bolt", "time bolt")
    def shear(self) -> Floats:
        if not len(self.bolts):
            return np.empty((len(self.time), 0))
        tension = (self.bolt_force @ self.bolt_axis)[..., None] * self.bolt_axis
        return np.linalg.norm(self.bolt_force - tension, axis=-1)

    @declared("N", "largest tension of the bolt", "bolt", name=None, key="tension")
    def bolt_tension(self) -> Floats:
        return self.tension.max(axis=0)

    @declared("N", "largest force that presses the specimen on the fixture at the bolt", "bolt", name=None,
              key="compression")  # fmt: skip
    def bolt_compression(self) -> Floats:
        return self.compression.max(axis=0)

    @declared("N", "largest shear of the bolt", "bolt", name=None, key="shear")
    def bolt_shear(self) -> Floats:
        return self.shear.max(axis=0)

    @property
    def lines(self) -> list[str]:
        """The largest loads in words."""
        worst = self.largest
        verdict = {None: "", True: ", PASS", False: ", NOT ACCEPTED"}[self.within_limit]
        limit = "" if self.spread_limit is None else f"{verdict} (limit {100 * self.spread_limit:.3g} %)"
        lines = [
            f"up to {worst.g:.4g} g at {place_words(worst.place)}, at {worst.time:.4g} s; spread over the specimen "
            f"{100 * self.spread_max:.3g} %{limit}",
            f"on the fixture up to {self.force_max:.4g} N and {self.moment_max:.4g} N m",
        ]
        if len(self.bolts):
            largest = {"tension": self.bolt_tension, "compression": self.bolt_compression, "shear": self.bolt_shear}
            words = (f"{name} up to {values.max():.4g} N" for name, values in largest.items())
            lines.append(f"bolts: {', '.join(words)}")
        return lines

    def __repr__(self) -> str:
        motion = f" {self.motion!r}" if self.motion else ""
        first, *others = self.lines
        return self._with_warnings(f"SpecimenLoads{motion} ({self.environment}): {first}", *others)

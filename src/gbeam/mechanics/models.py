"""The models, as data: which field, which truncation, which coordinates."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, replace
from typing import Annotated, Literal, get_args

from gbeam.constants import BY_STRAINS, ModelKind, Shapes
from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.guards.limits import SHAPES
from gbeam.guards.quantities import Count
from gbeam.mechanics.fields.basis import FAMILIES, Counts

StrainName = Literal["twist", "shear_y", "shear_z"]
COUNT = Count(0, SHAPES)
STRAINS: tuple[StrainName, ...] = get_args(StrainName)


@dataclass(frozen=True)
class Kind:
    """A kind of model.

    It has the order of the places' polynomial, None without end. Its flags tell whether coordinates are strains,
    equations are truncated to first order, a free hub feels Q_θ, and there are axial coordinates.
    """

    order: int | None = 2
    strains: bool = False
    truncated: bool = True
    hub_force: bool = True
    axial: bool = True


FIRST, FIRST_STRAINS = (1, 3), (2, 4)  # automatic numbers of shapes along and across the beam
MOST = 9  # across it
TORSION = "modes.twist gives a model torsion"
_ROWS: dict[ModelKind, Kind] = {
    "TLAM": Kind(order=1),
    "FOAM": Kind(),
    "SFOAM": Kind(hub_force=False, axial=False),
    "CFOAM": Kind(truncated=False),
    "fourth-order": Kind(order=4, truncated=False),
    "exact": Kind(order=None, truncated=False),
}
MODEL_KINDS: dict[str, Kind] = {name: replace(row, strains=name in BY_STRAINS) for name, row in _ROWS.items()}


@typed
@dataclass(frozen=True)
class Model:
    """Kind of model, and the numbers of its coordinates.

    Raises
    ------
    InputError
        If the kind or the shapes are unknown, a number is negative or of shapes that the kind has not, or there is no
        coordinate.

    Examples
    --------
    >>> gb.Model("exact", axial=1, z=3, twist=2).counts
    (1, 0, 3, 2, 0, 0)
    """

    kind: Annotated[
        ModelKind,
        "TLAM: linear, no foreshortening. FOAM: first order with foreshortening. SFOAM: FOAM without axial "
        "coordinates, Q_θ dropped as printed. CFOAM: FOAM's field, complete energy. fourth-order: exact's places to "
        "that order, complete. exact: any rotation",
    ]
    axial: Annotated[int, COUNT, "axial shapes; for `exact` and `fourth-order` of the stretch"] = 0
    y: Annotated[int, COUNT, "bending shapes along y; for `exact` and `fourth-order` of the curvature"] = 0
    z: Annotated[int, COUNT, "bending shapes along z; for `exact` and `fourth-order` of the curvature"] = 0
    shapes: Annotated[
        Shapes,
        "clamped-free: shapes of the bare uniform beam (for `exact` and `fourth-order`, polynomials); the default for "
        "these two and where `modes` are given. adapted: the modes at rest of this beam with its tapers, masses and "
        "root springs, of which fewer are needed; the default where `modes` are left out",
    ] = "clamped-free"
    automatic: Annotated[
        bool, "whether the numbers are gbeam's own, which a study raises until what they leave out is small"
    ] = False
    twist: Annotated[
        int,
        COUNT,
        "shapes of the twist, whose inertia is beam.rotary_inertia; with it, with shear, and on a curved line the "
        "other kinds are the Taylor polynomials of the exact places, to the order of their own",
    ] = 0
    shear_y: Annotated[int, COUNT, "shapes of the shear strain along y; a strain without shapes is rigid"] = 0
    shear_z: Annotated[int, COUNT, "shapes of the shear strain along z"] = 0

    @classmethod
    def of(cls, kind: ModelKind, shapes: Shapes | None = None) -> Model:
        """The model of a kind with the numbers of shapes that a study begins with.

        Parameters
        ----------
        kind : str
        shapes : str, optional
            Adapted ones unless given, of which fewer are needed; for exact and fourth-order, polynomials.
        """
        row = MODEL_KINDS.get(kind, Kind())
        axial, across = FIRST_STRAINS if row.strains else FIRST
        default: Shapes = "clamped-free" if row.strains else "adapted"
        return cls(kind, axial if row.axial else 0, across, across, shapes or default, automatic=True)

    def richer(self) -> Model | None:
        """Add two shapes across the beam, and one of each other strain, or None where that is too many."""
        if max(self.y, self.z) + 2 > MOST:
            return None
        y, z = (n + 2 if n else 0 for n in (self.y, self.z))
        axial, twist, shear_y, shear_z = (n + 1 if n else 0 for n in (self.axial, *self.counts[3:]))
        return replace(self, axial=axial, y=y, z=z, twist=twist, shear_y=shear_y, shear_z=shear_z)

    def with_strains(self, names: Collection[StrainName]) -> Model:
        """Return the model with one shape of each of some strains.

        Parameters
        ----------
        names : collection of str
            Of twist, shear_y and shear_z.
        """
        twist, shear_y, shear_z = (1 if name in names else getattr(self, name) for name in STRAINS)
        return replace(self, twist=twist, shear_y=shear_y, shear_z=shear_z)

    def __post_init__(self) -> None:
        """Refuse unknown kinds and shapes, and numbers of shapes that the kind cannot have."""
        words = (("kind", self.kind, tuple(MODEL_KINDS)), ("shapes", self.shapes, get_args(Shapes)))
        for name, value, choices in words:
            if value not in choices:
                raise InputError(name, f"is {value!r}", f"choose one of {', '.join(choices)}")
        for name, count in zip(FAMILIES, self.counts, strict=True):
            if not isinstance(count, int) or count < 0:
                raise InputError(f"modes.{name}", f"is {count!r}", "give a whole number, 0 or more")
        if sum(self.counts) == 0:
            raise InputError("modes", "are all zero", "give at least one mode in one direction")
        if self.axial and not MODEL_KINDS[self.kind].axial:
            raise InputError(
                "modes.axial",
                f"is {self.axial} for SFOAM, which has no axial coordinates",
                "give 0, or use FOAM",
            )

    @property
    def counts(self) -> Counts:
        """Numbers of shapes: axial, along y, along z, of twist, of shear along y and along z."""
        return self.axial, self.y, self.z, self.twist, self.shear_y, self.shear_z

    @property
    def row(self) -> Kind:
        """The model's row in the table."""
        return MODEL_KINDS[self.kind]

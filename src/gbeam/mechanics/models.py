"""The models, as data: which field, which truncation, which coordinates."""

from __future__ import annotations

from dataclasses import dataclass

from gbeam.errors import InputError


@dataclass(frozen=True)
class Kind:
    """A row of the table of models.

    Parameters
    ----------
    exact : bool
        The exact field, or the one of the projected displacements.
    foreshortening : bool
        Whether transverse displacement shortens the projected field.
    truncated : bool
        Whether the Taylor polynomial of the places ends with the second order and the equations with the first, which
        makes them linear on a prescribed base.
    hub_force : bool
        Whether a free hub feels Q_θ.
    axial : bool
        Whether there are axial coordinates.
    """

    exact: bool = False
    foreshortening: bool = True
    truncated: bool = True
    hub_force: bool = True
    axial: bool = True


SHAPES = ("clamped-free", "adapted")
KINDS = {
    "TLAM": Kind(foreshortening=False),
    "FOAM": Kind(),
    "SFOAM": Kind(hub_force=False, axial=False),
    "CFOAM": Kind(truncated=False),
    "exact": Kind(exact=True, truncated=False),
}


@dataclass(frozen=True)
class Model:
    """Which model to use and how many coordinates.

    Parameters
    ----------
    kind : str
        TLAM, FOAM, SFOAM (as printed: no axial coordinates, Q_θ dropped), CFOAM or exact. FOAM with ``axial=0`` is
        the Lagrangian form of SFOAM.
    axial, y, z : int
        Numbers of axial shapes and of bending shapes along y and along z; for exact: strain shapes, and rotation
        shapes for bending along y and along z.
    shapes : str
        clamped-free: those of the bare uniform beam (for exact, polynomials). adapted: the modes at rest of the beam
        with its tapers, bodies and root springs.

    Raises
    ------
    InputError
        If the kind or the shapes are unknown, a number is negative, or there is no coordinate.
    """

    kind: str
    axial: int = 0
    y: int = 0
    z: int = 0
    shapes: str = "clamped-free"

    def __post_init__(self) -> None:
        for name, value, choices in (("kind", self.kind, tuple(KINDS)), ("shapes", self.shapes, SHAPES)):
            if value not in choices:
                raise InputError(name, f"is {value!r}", f"choose one of {', '.join(choices)}")
        for name, count in zip(("axial", "y", "z"), self.counts, strict=True):
            if not isinstance(count, int) or count < 0:
                raise InputError(f"modes.{name}", f"is {count!r}", "give a whole number, 0 or more")
        if sum(self.counts) == 0:
            raise InputError("modes", "are all zero", "give at least one mode in one direction")
        if self.axial and not KINDS[self.kind].axial:
            raise InputError(
                "modes.axial",
                f"is {self.axial} for SFOAM, which has no axial coordinates",
                "give 0, or use FOAM",
            )

    @property
    def counts(self) -> tuple[int, int, int]:
        """Numbers of shapes: axial, along y, along z."""
        return self.axial, self.y, self.z

    @property
    def row(self) -> Kind:
        """The model's row in the table."""
        return KINDS[self.kind]

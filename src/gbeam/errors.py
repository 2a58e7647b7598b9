"""Errors that gbeam raises: wrong input, with place, problem and fix, or a computation that failed."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any


class GbeamError(Exception):
    """Base of everything that gbeam raises on purpose.

    Examples
    --------
    >>> try:
    ...     gb.Material(density=-2700, youngs_modulus=70e9)
    ... except gb.GbeamError as error:
    ...     print(error)
    density is -2700 kg/m³; give a positive, finite value
    """


class InputError(GbeamError, ValueError):
    """The input is wrong (exit status 2).

    Parameters
    ----------
    where : str
        Path of the quantity in the scenario's words, e.g. ``beam.masses[0].at``; relative to the object that
        raises it (``masses[0].at``) until a caller that knows more adds a prefix with :meth:`within`.
    problem : str
        What is wrong, with the value: ``is 0.4 m, beyond the beam's tip``.
    fix : str
        What would be right: ``give a position between 0 and 0.3 m``.

    Examples
    --------
    >>> try:
    ...     gb.PointMass(at=0.1, mass=-1.0)
    ... except gb.InputError as error:
    ...     print(error.where, "|", error.problem, "|", error.fix)
    mass | is -1 kg | give a non-negative, finite value
    """

    of_type = False  # whether it is of an argument's type, which whoever was given the argument may say better

    def __init__(self, where: str, problem: str, fix: str) -> None:
        self.where, self.problem, self.fix = where, problem, fix
        super().__init__(f"{where} {problem}; {fix}" if where else f"{problem}; {fix}")

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.where, self.problem, self.fix)

    def at(self, where: str) -> InputError:
        """Return the same error with another place, `where`."""
        return InputError(where, self.problem, self.fix)

    def within(self, prefix: str) -> InputError:
        """Return the same error with `prefix` and a dot before its place."""
        joint = "" if not prefix or not self.where or self.where.startswith("[") else "."
        return self.at(f"{prefix}{joint}{self.where}")


@contextmanager
def naming(where: str | Mapping[str, str]) -> Iterator[None]:
    """Give another place to InputErrors raised inside. A mapping has the new place of each old one or its beginning."""
    try:
        yield
    except InputError as error:
        if isinstance(where, str):
            raise error.at(where) from None
        first = error.where.partition(".")[0].partition("[")[0]
        place = where.get(error.where) or where.get(first, first) + error.where[len(first) :]
        raise error.at(place) from None


@contextmanager
def placing_within(prefix: str) -> Iterator[None]:
    """Put a prefix before the place of InputErrors raised inside: :meth:`InputError.within`."""
    try:
        yield
    except InputError as error:
        raise error.within(prefix) from None


class ComputationError(GbeamError, RuntimeError):
    """A computation failed (exit status 1).

    Parameters
    ----------
    outcome : str
        The named outcome: ``"diverged"`` or ``"not converged"``.
    message : str
        What happened, where, and what to try next.

    Examples
    --------
    >>> strip = gb.Section.rectangle(width=0.02, thickness=0.004)
    >>> beam = gb.Beam(0.3, strip, gb.Material(2700, 70e9), damping_ratio=0.01)
    >>> structure = gb.assemble(beam, "FOAM", axial=1, y=2, z=2)
    >>> hub = gb.Hub(radius=0.0, rate=0.0)
    >>> try:
    ...     gb.shape_command(structure, hub, angle=1.0, duration=0.02, limit=1.0)
    ... except gb.ComputationError as error:
    ...     print(error.outcome)
    limits exceeded
    """

    def __init__(self, outcome: str, message: str) -> None:
        self.outcome = outcome
        super().__init__(message)

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.outcome, *self.args)

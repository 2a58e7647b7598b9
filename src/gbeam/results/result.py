"""Base of all results: short words on the screen, and the doors to xarray, to a file, a figure and a report."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar, Generic, Literal, TypeVar

from gbeam.arrays.tree import Value
from gbeam.arrays.types import Complex as Complex
from gbeam.arrays.types import Flags as Flags
from gbeam.arrays.types import Floats as Floats
from gbeam.guards.arguments import typed
from gbeam.results.base import Part as Part
from gbeam.results.base import brief as brief
from gbeam.results.declared import document, fact
from gbeam.results.doors import Panels, doors
from gbeam.results.provenance import Provenance


def each_once(sentences: Mapping[str, Iterable[str]]) -> tuple[str, ...]:
    """Sentences of answers by the motion's name, each once, and with the names unless it is of all or says its own."""
    names_by_sentence: dict[str, list[str]] = {}
    for name, own_sentences in sentences.items():
        for sentence in own_sentences:
            names_by_sentence.setdefault(sentence, []).append(name)
    lines = []
    for sentence, names in names_by_sentence.items():
        named = len(names) == len(sentences) or sentence.startswith(f"motion.{names[0]}")
        lines.append(sentence if named else f"{', '.join(names)}: {sentence}")
    return tuple(lines)


def part_words(span: tuple[float, float], flight: tuple[float, float]) -> str:
    """Part of a flight in words: ``0 to 6 of 15.99 s``, ``102 to 108 of 100 to 116 s``; all s."""
    beginning = "" if flight[0] == 0 else f"{flight[0]:.6g} to "
    return f"{span[0]:.6g} to {span[1]:.6g} of {beginning}{flight[1]:.6g} s"


@dataclass(frozen=True, eq=False, kw_only=True)
class Result(Value):
    """Base of what an analysis returns as a whole: it goes to xarray and to a netCDF file.

    Parameters
    ----------
    warnings : tuple of str
        Why it may not be what it seems: implausible input, or an answer that is not to be trusted.
    notes : tuple of str
        What may be meant so, and is easily overlooked, as gravity that is left out.
    provenance : Provenance or None
        The scenario, the records and the command that it comes from, where there is a scenario.
    """

    listed_by: ClassVar[str] = ""  # field that names each where JSON lists several by their motion
    unnamed: ClassVar[str] = ""  # name of one that has none there
    warnings: tuple[str, ...] = fact("why it may not be what it seems", default=(), repr=False)
    notes: tuple[str, ...] = fact(
        "what may be meant so, and is easily overlooked", optional=True, default=(), repr=False
    )
    provenance: Provenance | None = field(default=None, repr=False)

    @property
    def kept_every(self) -> int:
        """Number of samples of histories of which a file has one."""
        return 1

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        document(cls)

    def _with_warnings(self, *lines: str) -> str:
        """Lines on the screen, with the warnings and notes below."""
        warnings = [f"warning: {sentence}" for sentence in self.warnings]
        notes = [f"note: {sentence}" for sentence in self.notes]
        return "\n  ".join([*lines, *warnings, *notes])

    def _repr_html_(self) -> str:
        """The verdict and a small table, in notebooks."""
        return doors().summary(self)

    def to_xarray(self) -> Any:
        """Return the result with named dimensions, units and frames.

        Returns
        -------
        xarray.Dataset
            Of a :class:`~gbeam.Study` an xarray.DataTree.
        """
        return doors().to_xarray(self)

    @typed
    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the result to a netCDF file, whole or not at all; xarray, MATLAB and h5py open it.

        Parameters
        ----------
        path : path
            Replaced if it exists.

        Raises
        ------
        OSError
            If it cannot be written.
        """
        doors().save(self, path)

    @typed
    def report(self, path: str | os.PathLike[str]) -> None:
        """Write the result as one page of HTML that opens without a network: tables, plots, and the beam in motion.

        Parameters
        ----------
        path : path
            Replaced if it exists.

        Raises
        ------
        OSError
            If it cannot be written.
        """
        doors().report(self, path)


NOT_KNOWN = "not known"


@dataclass(frozen=True, eq=False, kw_only=True)
class Decided(Result):
    """A result that says whether a state is stable, unless that is not known."""

    outcome: str = fact(
        "how it ended",
        note="done, or not known: stiffness of first order would not keep a body that bends as far",
        default="done",
    )
    message: str = fact("why it is not known", default="")


FigureName = TypeVar("FigureName", bound=str)


class Figured(Result, Generic[FigureName]):
    """A result that has figures, of these names."""

    def view(self) -> Any:
        """Show what moves in a notebook: a study, a response, the shapes of modes, or where a system rests.

        Returns
        -------
        anywidget.AnyWidget
            A notebook shows it; needs the extra ``notebook``.

        Raises
        ------
        InputError
            If there is no beam in motion to show, or the extra is not installed.
        """
        return doors().view(self)

    @typed
    def plot(self, what: FigureName | Literal[""] = "", *, title: str = "") -> Panels:
        """Draw the result with Matplotlib.

        Parameters
        ----------
        what : str
            Which of its figures; the first that the result has by default. Of a response: tip, base, sensors, loads,
            stress, tracking, axes_rate, axes_acceleration, axes_jerk, hub; of a study: tip, sizes, or any other
            followed by a space and a motion's name; of a comparison: parts, parts x, parts y, parts z but for the main
            axis, shock; of rest: static, and loads, followed by the names of a body, where there are several, and of a
            motion; of a plan: those of its axes and tracking; of a system: points, coordinates, sensors, loop, energy,
            and loads or stress followed by a space and a body's name; of sweeps and sensitivities: their measures. Type
            checkers know the names that are always the same.
        title : str
            First line above the figure.

        Returns
        -------
        tuple of matplotlib.axes.Axes
            The figure's panels from top to bottom, a tuple also where there is one: ``(panel,) = modes.plot()``. Its
            ``figure`` is made without pyplot: ``result.plot().figure.savefig(path)`` writes it. A notebook shows it.

        Raises
        ------
        InputError
            If it has no such figure.
        """
        return doors().plot(self, what, title)

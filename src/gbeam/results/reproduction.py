"""A result computed again, and how the two differ."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from gbeam.results.result import Part

SAME, ELSEWHERE = 0.0, 1e-9  # differences allowed in the same environment, and in another


@dataclass(frozen=True)
class Difference:
    """A variable or an attribute that came out otherwise.

    Parameters
    ----------
    name : str
        Path in the file.
    size : float
        Largest difference over the largest value; infinite where the two cannot be compared.
    what : str
    """

    name: str
    size: float
    what: str

    def __str__(self) -> str:
        return f"{self.name}: {self.what}"


@dataclass(frozen=True, repr=False, eq=False)
class Reproduction(Part):
    """A result computed again from what its file says, and compared with it.

    Parameters
    ----------
    file : str
    compared : int
        Number of variables and attributes compared.
    differences : tuple of Difference
        The largest first.
    changed : mapping of str to (str, str)
        What of gbeam, Python, the platform and the dependencies is otherwise: then, and now.
    """

    file: str
    compared: int
    differences: tuple[Difference, ...]
    changed: Mapping[str, tuple[str, str]]

    @property
    def tolerance(self) -> float:
        """Largest difference allowed: none in the same environment, 1e-9 in another."""
        return ELSEWHERE if self.changed else SAME

    @property
    def reproduced(self) -> bool:
        """Whether no difference is larger."""
        return all(each.size <= self.tolerance for each in self.differences)

    def __repr__(self) -> str:
        end = "reproduced" if self.reproduced else "NOT reproduced"
        allowed = f"within {self.tolerance:g}" if self.tolerance else "to the last digit"
        lines = [f"Reproduction of {self.file}: {end} {allowed}, {self.compared} values and arrays compared"]
        lines += [str(each) for each in self.differences[:10]]
        lines += [f"{name} was {then}, is {now}" for name, (then, now) in self.changed.items()]
        return "\n  ".join(lines)

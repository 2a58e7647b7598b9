"""A run of a structure or of a system: how it is posed and made, what is read from it, and the response it leaves."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Self

from gbeam.analysis.response.settings import ResponseSettings
from gbeam.arrays.types import Floats
from gbeam.integrate.equations import Trajectory
from gbeam.progress import Progress
from gbeam.results.errors import StepErrors


@dataclass(frozen=True)
class Run(ABC):
    """A trajectory with the length of its steps, s, of a structure or a system, and what is read from it."""

    trajectory: Trajectory
    step: float
    posed: Any

    @classmethod
    @abstractmethod
    def prepared(cls, structure: Any, motion: Any, settings: ResponseSettings) -> tuple[Any, ResponseSettings]:
        """The motion over the flight's times, and the settings of such runs; InputError of what they cannot be of."""

    @classmethod
    @abstractmethod
    def poses(cls, structure: Any, motion: Any, settings: ResponseSettings) -> Iterator[Any]:
        """The problem posed with each of the steps of results to try, until one is enough."""

    @classmethod
    @abstractmethod
    def by_steps(cls, posed: Any, step: float, progress: Progress = None) -> Self:
        """Run what is posed by steps of a length, s."""

    @classmethod
    @abstractmethod
    def traced(cls, structure: Any, motion: Any, settings: ResponseSettings, step: float, name: str) -> Any:
        """The response whose values JAX traces, by given steps, without a look at them."""

    @abstractmethod
    def described(self, errors: StepErrors, name: str, progress: Progress = None) -> Any:
        """The response that it leaves, with its errors beside those of the steps."""

    @property
    def stride(self) -> int:
        """Number of its steps in one of the results, whose times all motions of a study share."""
        return 1 if self.posed.settings.step is not None else round(self.posed.kept / self.step)

    @property
    def bends(self) -> bool:
        """True if a law bends within steps, whose error then depends on where."""
        return False

    @property
    def missed(self) -> tuple[str, ...]:
        """Warning of what the steps may miss: then their error is unknown."""
        return ()

    @property
    def followed(self) -> bool:
        """True if steps are refined for the loads, too."""
        return True

    @property
    def whole(self) -> bool:
        """True if it came to its end."""
        return self.trajectory.whole

    @property
    @abstractmethod
    def moved(self) -> Floats:
        """Displacement of the tip, or of all points side by side, (t, 3 p) m."""

    @property
    @abstractmethod
    def peaks(self) -> list[Floats]:
        """Peaks of the tip's displacement and of the root's moment, (4,) each; none where the history is judged."""

    @abstractmethod
    def loads(self, stride: int) -> Sequence[Floats]:
        """Histories (t, ..., k) of force, moment and stress of each beam, at every so many steps; of one beam the
        stress is left out where no errors are estimated.
        """

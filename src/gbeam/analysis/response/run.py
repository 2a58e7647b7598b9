"""A run of a structure or of a system: how it is posed and made, and what errors and the response need of it."""

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
    """A trajectory of a structure or a system, the length of its steps, s, and the problem that was run."""

    trajectory: Trajectory
    step: float
    posed: Any

    @classmethod
    @abstractmethod
    def prepared(cls, structure: Any, motion: Any, settings: ResponseSettings) -> tuple[Any, ResponseSettings]:
        """The motion over the flight's times, and the settings with an integrator; InputError if they cannot be run."""

    @classmethod
    @abstractmethod
    def poses(cls, structure: Any, motion: Any, settings: ResponseSettings) -> Iterator[Any]:
        """Yield the problem with each of the steps of results to try, the longest first."""

    @classmethod
    @abstractmethod
    def by_steps(cls, posed: Any, step: float, progress: Progress = None) -> Self:
        """Run a problem by steps of a length, s."""

    @classmethod
    @abstractmethod
    def traced(cls, structure: Any, motion: Any, settings: ResponseSettings, step: float, name: str) -> Any:
        """Response traced by JAX, by given steps: no branch depends on its values."""

    @abstractmethod
    def described(self, errors: StepErrors, name: str, progress: Progress = None) -> Any:
        """Response made of the run, with the errors of the steps and others that the settings ask for."""

    @property
    def stride(self) -> int:
        """Number of steps of the run in one step of the results."""
        return 1 if self.posed.settings.step is not None else round(self.posed.kept / self.step)

    @property
    def bends(self) -> bool:
        """True if a force law has corners within steps, so that errors do not fall by the order of the scheme."""
        return False

    @property
    def missed(self) -> tuple[str, ...]:
        """Warning of events that the steps may miss, which makes their error unknown; else empty."""
        return ()

    @property
    def followed(self) -> bool:
        """True if automatic steps are refined until errors of loads are small, too."""
        return True

    def aims(self, aim: float, enough: float) -> list[float]:
        """Errors of each history that :attr:`moved` at which automatic steps aim; `enough` is the largest."""
        return [aim] * len(self.moved)

    @property
    def whole(self) -> bool:
        """True if the run came to its end."""
        return self.trajectory.whole

    @property
    @abstractmethod
    def moved(self) -> Sequence[Floats]:
        """Displacement of the tip, or of each body's points and of all places side by side, (t, 3 p) m each."""

    @property
    @abstractmethod
    def peaks(self) -> list[Floats]:
        """Peaks of the tip's displacement and of the root's moment, (4,) each; empty if histories alone are judged."""

    @abstractmethod
    def loads(self, stride: int) -> Sequence[Floats]:
        """Histories (t, ..., k) of force, moment and stress of each body in turn, at every `stride`-th step; no stress
        of a structure without an estimate of errors.
        """

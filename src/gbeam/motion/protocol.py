"""Protocol of motions of the base."""

from __future__ import annotations

from typing import Any, ClassVar, Protocol, Self, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from gbeam.motion.bases.base import Base


@runtime_checkable
class Motion(Protocol):
    """A flight, a centrifuge or a hub.

    ``kind`` names which. Where ``free`` is true the motion is a result: a hub whose rate is not given. NumPy in, NumPy
    out; JAX arrays and tracers, in the times or in the motion's own values, pass through.
    """

    kind: ClassVar[str]

    @property
    def free(self) -> bool:
        """Whether the base's motion is an unknown of the equations of motion."""
        ...

    def base(self, t: Any) -> Base:
        """Motion of the base at times `t` (s, any shape)."""
        ...

    def corners(self, step: float) -> NDArray[np.float64]:
        """Times that steps of length `step` (s) should not pass unseen, s, ascending."""
        ...

    def over(self, start: float, end: float) -> Self:
        """Return the motion prepared for times from `start` to `end`, s."""
        ...

    def beyond(self, start: float, end: float) -> tuple[Any, Any]:
        """Return the times that a machine moves before `start` and after `end`, to and from standstill, s."""
        ...

"""Temperature of a body."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np

from gbeam.arrays.namespace import is_jax, namespace
from gbeam.arrays.tree import Value, record
from gbeam.arrays.types import Floats
from gbeam.guards.arguments import typed
from gbeam.guards.quantities import Quantity
from gbeam.motion.profiles.piecewise import constant
from gbeam.motion.profiles.profile import Profile


@typed
@dataclass(frozen=True, eq=False)
class Temperature(Value):
    """Temperature of a body, the same throughout, and that at which it is free of strain.

    Raises
    ------
    InputError
        If a temperature is not above absolute zero.

    Examples
    --------
    >>> strip = gb.Section.rectangle(width=0.02, thickness=0.004)
    >>> metal = gb.Material(2700, 70e9, expansion=23e-6)
    >>> clamp = gb.Support(at=0.6, holds=["x", "z", "ry"])
    >>> warm = gb.Temperature("24 degC", reference="20 degC")
    >>> lowest = []
    >>> for temperature in (None, warm):
    ...     beam = gb.Beam(0.6, strip, metal, supports=[clamp], temperature=temperature)
    ...     lowest.append(gb.modes(gb.assemble(beam, "FOAM", axial=1, z=5)).frequency[0])
    >>> print(f"{lowest[0]:.1f} Hz, heated by 4 K {lowest[1]:.1f} Hz")
    58.2 Hz, heated by 4 K 35.8 Hz
    """

    value: Annotated[
        float | Profile,
        Quantity("temperature", "positive"),
        'temperature, in K or as a text such as "80 degC", or a profile of it over time',
    ]
    reference: Annotated[
        Annotated[float, Quantity("temperature", "positive")], "temperature at which the body is free of strain"
    ]

    @property
    def profiles(self) -> tuple[Rise, Any]:
        """Rise above the reference over time and zeros, in place of the force and moment of a load."""
        return Rise(self.value, self.reference), constant(np.zeros(3))


@record
class Rise:
    """Rise of a temperature above a reference, K, as the first of three components; called as ``rise(t)``."""

    value: Any
    reference: Any

    def __call__(self, t: Any) -> Any:
        """Rise and two zeros (..., 3) at times t (...), s."""
        xp = namespace(t, self.value if is_jax(self.value) else 0.0)
        value = self.value(t) if callable(self.value) else self.value
        rise = value - self.reference + 0.0 * xp.asarray(t)
        return xp.stack([rise, 0.0 * rise, 0.0 * rise], axis=-1)

    def corners(self, step: float) -> Floats:
        """Times that steps of length `step` (s) should not pass unseen, s."""
        return np.asarray(self.value.corners(step)) if callable(self.value) else np.zeros(0)

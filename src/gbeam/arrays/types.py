"""Arrays of numbers, by what they hold, in annotations."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]
Complex = NDArray[np.complex128]
Indices = NDArray[np.intp]
Numbers = Sequence[float] | NDArray[Any]  # components of a vector, or one of each

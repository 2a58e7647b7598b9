"""Arrays of numbers, by what they hold, in annotations."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]
Complex = NDArray[np.complex128]
Indices = NDArray[np.intp]

"""Where a beam rests relative to its base, and the derivatives of its equations there."""

"""Arrays: NumPy's, or JAX's where something is traced; records of them; JAX's settings."""

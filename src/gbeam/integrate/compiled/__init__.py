"""Steps that JAX compiles: of nonlinear equations, and of many runs at once."""

"""How a response changes with what it is computed from."""

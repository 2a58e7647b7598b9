"""Which groups, variables and attributes of a file hold each result."""

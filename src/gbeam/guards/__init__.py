"""Guards of input: checks of single values, limits of size, plausible and possible values."""

"""What an input may be: checks of single values, limits of size, plausible and possible values."""

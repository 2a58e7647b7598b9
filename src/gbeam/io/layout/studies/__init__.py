"""Files of what many runs say together."""

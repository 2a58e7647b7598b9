"""The terminal: what is printed, how failures read, signals and streams that end."""

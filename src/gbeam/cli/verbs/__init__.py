"""One file per verb of the command line: read, call, print."""

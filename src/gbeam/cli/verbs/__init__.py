"""Verbs of the command line, a file for those that are alike: read, call, print."""

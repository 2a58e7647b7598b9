"""Verbs of a run: the response in every environment, again, by every model; the machine's motions and mounting."""

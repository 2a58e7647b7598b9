"""Steady states: where a beam rests on a moving base, whether it stays there, and how it vibrates about it."""

"""Answers of systems, trees of bodies: where they rest, how they vibrate, how they move, and their control."""

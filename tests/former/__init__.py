"""Answers of 0.3.0.dev0, which had a program for one structure and one for systems, and the cases that they are of."""

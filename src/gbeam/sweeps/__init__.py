"""One question over many scenarios: which values vary, what is measured of each case, and a store that survives.

A case is the scenario with some of its values replaced, as `--set` replaces them; a measure is a figure of a verb's
JSON.
"""

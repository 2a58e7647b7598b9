"""A scenario's values: paths, units and kinds, distributions in their place, and the closest name of a misspelt one."""

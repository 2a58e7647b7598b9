"""From a structure to its equations: shapes, displacement fields, energies, virtual work, equations, models."""

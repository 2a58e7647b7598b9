"""How cases are computed: one, several together, in processes, on a scheduler."""

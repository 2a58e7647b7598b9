"""How fits and optima search: within bounds, from several starts, by derivatives."""

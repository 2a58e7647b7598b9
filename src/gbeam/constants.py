"""Constants of nature, and of the models."""

STANDARD_GRAVITY = 9.80665  # m/s²
BY_STRAINS = frozenset({"exact", "fourth-order"})  # models whose coordinates are strains, without a unit

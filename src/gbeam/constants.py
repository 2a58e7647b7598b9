"""Constants of nature and of the models, and the names that Python and scenarios choose among."""

from typing import Literal

STANDARD_GRAVITY = 9.80665  # m/s²
BY_STRAINS = frozenset({"exact", "fourth-order"})  # models whose coordinates are strains, without a unit

ModelKind = Literal["TLAM", "FOAM", "SFOAM", "CFOAM", "fourth-order", "exact"]
Shapes = Literal["clamped-free", "adapted"]
Pointing = Literal["outward", "inward"]
InverseName = Literal["quasi-static", "flat", "exact", "planned"]
Mounting = Literal["upright", "inverted"]
Start = Literal["rest", "pre-yawed", "idle"]
Integrator = Literal["newmark", "hht", "generalized-alpha", "gauss"]
ToleranceOf = Literal["peak", "instant"]
Sampler = Literal["sobol", "latin", "random", "saltelli"]

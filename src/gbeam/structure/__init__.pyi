"""The door of this room: names that tests, validation, benchmarks and fuzz read, imported when first used."""

from .beam import fibre_strain as fibre_strain
from .section import extreme_stresses as extreme_stresses
from .section import worst_fibres as worst_fibres
from .shapes import SHAPES as SHAPES
from .shapes import Dimensions as Dimensions
from .shapes import rectangle_stresses as rectangle_stresses
from .shapes import saint_venant as saint_venant
from .shapes import von_mises as von_mises

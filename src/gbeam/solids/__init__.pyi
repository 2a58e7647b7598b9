"""The door of this room: names that tests, validation, benchmarks and fuzz read, imported when first used."""

from .elements import STRAIN as STRAIN
from .elements import chunks as chunks
from .elements import mass_matrix as mass_matrix
from .elements import stiffness_matrix as stiffness_matrix
from .files import parts_of as parts_of
from .files import read_mesh as read_mesh
from .linked import Linked as Linked
from .links import WAYS as WAYS
from .links import attached as attached
from .links import coupling as coupling
from .norms import LargestNorms as LargestNorms
from .shape_functions import KINDS as KINDS
from .shape_functions import reference as reference
from .shape_functions import shape_functions as shape_functions
from .stress import VERTICES as VERTICES
from .stress import NodalStress as NodalStress
from .stress import critical_plane_stress as critical_plane_stress
from .stress import deviatoric as deviatoric
from .stress import principal as principal
from .stress import surface_of as surface_of

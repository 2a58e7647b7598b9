"""The door of this room: names that tests, validation, benchmarks and fuzz read, imported when first used."""

from .hdf5 import contents as contents
from .hdf5 import image as image
from .layout import Group as Group
from .layout import Variable as Variable
from .layout import in_files as in_files
from .layout import whole_group as whole_group
from .models.registry import model_of as model_of
from .netcdf import csv_of as csv_of
from .netcdf import read_stored as read_stored
from .netcdf import stored as stored
from .table import read_clock as read_clock

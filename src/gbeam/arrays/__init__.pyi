"""The door of this room: names that tests, validation, benchmarks and fuzz read, imported when first used."""

from .jax_setup import with_slope as with_slope
from .namespace import is_jax as is_jax
from .namespace import namespace as namespace
from .tree import Value as Value
from .tree import altered as altered
from .tree import arguments_of as arguments_of
from .tree import each_leaf as each_leaf
from .tree import record as record
from .types import Floats as Floats

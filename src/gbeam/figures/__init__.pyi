"""The door of this room: names that tests, validation, benchmarks and fuzz read, imported when first used."""

from .bodies import carried_at_root as carried_at_root
from .description import Figure as Figure
from .description import Line as Line
from .description import Panel as Panel
from .description import components as components
from .description import limit_levels as limit_levels
from .description import scale_of as scale_of
from .description import stretches as stretches
from .registry import figure_names as figure_names
from .registry import figure_of as figure_of
from .registry import figures_of as figures_of
from .steady import campbell as campbell

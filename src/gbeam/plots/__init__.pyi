"""The door of this room: names that tests, validation, benchmarks and fuzz read, imported when first used."""

from .draw import BINS as BINS
from .draw import BROAD as BROAD
from .draw import COLUMNS as COLUMNS
from .draw import ENVELOPE as ENVELOPE
from .draw import STYLE as STYLE
from .draw import draw as draw
from .draw import line as line
from .output import DPI as DPI
from .output import plot as plot
from .output import save as save
from .output import signature as signature
from .output import write_figures as write_figures

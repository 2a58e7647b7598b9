"""The door of this room: names that tests, validation, benchmarks and fuzz read, imported when first used."""

from .centrifuge import parse as parse
from .entry import main as main
from .failures import lacks_memory as lacks_memory
from .failures import report_defect as report_defect
from .outputs import write_json as write_json
from .process import FIGURES as FIGURES
from .process import Watch as Watch
from .process import shorten_warnings as shorten_warnings
from .program import arguments as arguments
from .program import function as function
from .program import parsed as parsed
from .program import verbs as verbs
from .publication import publish as publish

"""The door of this room: names that tests, validation, benchmarks and fuzz read, imported when first used."""

from .access import Door as Door
from .documents import SAMPLES as SAMPLES
from .documents import changes as changes
from .documents import described as described
from .documents import head as head
from .documents import load_curves as load_curves
from .documents import suggested as suggested
from .jobs import LIMITED as LIMITED
from .jobs import Jobs as Jobs
from .server import create_app as create_app
from .verbs import arguments as arguments
from .verbs import verb_facts as verb_facts
from .verbs import verbs as verbs

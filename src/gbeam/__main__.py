"""``python -m gbeam``: the command line, where the script is not on the path."""

import sys

from gbeam.cli import main

sys.exit(main())

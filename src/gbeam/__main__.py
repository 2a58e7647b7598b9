"""``python -P -m gbeam``: the command line, where the script is not on the path.

Without ``-P`` Python itself takes its first modules, and gbeam, from the current folder.
"""

import sys

from gbeam.cli.entry import main

sys.exit(main())

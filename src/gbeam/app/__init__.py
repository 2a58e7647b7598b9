"""The local web app: scenarios edited, run, watched and compared in a browser, by a server on this computer only.

`server` has the routes, behind the door of `access`. `documents` reads and edits scenarios, `files` keeps records
within one folder, `jobs` runs the command line in processes of limited time and memory, one after the other. The page
is `assets`, built from `web/` by `make web`; a mesh on it is drawn by the viewer of the reports.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

"""The command line: verbs, imported when they are called.

A verb is a function with annotated parameters that reads a scenario, calls a public function of gbeam, prints what
`gbeam.report` makes of the result, and returns its exit status. To add one, declare a question in `gbeam.questions`,
or write a function in a module of this folder and name that in `program`. Errors are raised; `failures` prints them.
Importing this package imports no verb; `entry` sets up signals first.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

"""The parser of the command line, and what becomes of what a verb raises."""

from __future__ import annotations

import os
from collections.abc import Callable
from inspect import BoundArguments

# A beam's matrices are small: threads of OpenBLAS, started as NumPy and SciPy are imported, would only spin.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
# No plugin has a part in reading a scenario, and the search for plugins takes as long as the reading.
os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")

from cyclopts import App, ArgumentCollection, CycloptsError

import gbeam
from gbeam.cli.failures import lacks_memory, report, report_defect, report_memory, report_syntax
from gbeam.cli.process import end_at_once, note
from gbeam.errors import GbeamError
from gbeam.guards.limits import WORDS
from gbeam.questions import QUESTIONS

# The file of each verb that has one, and its help where no question says it: not only in its own docstring, so that
# `gbeam --help` imports none.
_FILES = {
    "run": ("responses", ""),
    "linearize": ("questions", "State-space model A, B, C, D about the equilibrium at one time of a motion."),
    "models": ("responses", "Compute a scenario by every model, and compare them with the exact one."),
    "plan": ("centrifuge", ""),
    "place": ("centrifuge", ""),
    "sweep": ("many", "Figures of many cases: over ranges, lists or samples of any values of a scenario."),
    "sensitivity": ("many", "Which values of a scenario a figure depends on, and how much."),
    "report": ("responses", "Write a result as one page of HTML: tables, plots that zoom, and the motion in 3-D."),
    "optimize": ("searches", "Values of a scenario at which a figure is least, within limits."),
    "shape": ("searches", "The rate or torque of a hub that leaves the least vibration of its beam."),
    "fit": ("searches", "Values of a scenario from a measurement, by least squares."),
    "rerun": ("responses", "Compute a result again from what its file says, and compare every number."),
    "app": ("files", "Edit, run and compare scenarios in a browser, on this computer only."),
    "check": ("files", "Say what a scenario means, without computing a response."),
    "new": ("files", "Write a commented scenario to start from."),
    "schema": ("files", "Print the JSON schema of scenario files, for editors."),
}
_INTERRUPTED = 130


def run(tokens: list[str]) -> int:
    """Run a verb, print what went wrong, if anything, and return the exit status."""
    as_json = "--json" in tokens
    if len(tokens) > WORDS:
        return report_syntax(f"The command line has {len(tokens)} words, and {WORDS} are read at most.", as_json)
    note(tokens)
    try:
        status = _app(tokens[0] if tokens else "")(
            tokens, exit_on_error=False, print_error=False, result_action="return_value"
        )
    except CycloptsError as error:
        return report_syntax(str(error), as_json)
    except GbeamError as error:
        return report(error, as_json)
    except KeyboardInterrupt:  # called from Python: the command line's own process ends in `process`
        return _INTERRUPTED
    except OSError:
        raise
    except Exception as error:
        if lacks_memory(error):
            status = report_memory(error, as_json)
            end_at_once(status)
            return status
        return report_defect(error, tokens, as_json)
    return status if isinstance(status, int) else 0


def parsed(tokens: list[str]) -> tuple[Callable[..., object], BoundArguments]:
    """The verb that a command line calls, and its arguments; ValueError where it calls none."""
    try:
        verb, bound, _ = _app(tokens[0] if tokens else "").parse_args(tokens, exit_on_error=False, print_error=False)
    except CycloptsError as error:
        raise ValueError(str(error)) from None
    return verb, bound


def verbs() -> dict[str, str]:
    """Every verb, with the words of what it answers."""
    known = {name: each.about for name, each in QUESTIONS.items()}
    return known | {verb: about or known[verb] for verb, (_, about) in _FILES.items()}


def function(verb: str) -> Callable[..., object]:
    """The function of a verb."""
    called = _app(verb)[verb].default_command
    assert called is not None
    return called


def arguments(verb: str) -> ArgumentCollection:
    """The arguments of a verb, with the words, choices and defaults of each."""
    return _app(verb)[verb].assemble_argument_collection()


def _app(chosen: str) -> App:
    app = App(
        name="gbeam",
        help="How a flexible beam responds while its base moves a lot: in flight, on a centrifuge, on a hub.",
        version=gbeam.__version__,
        help_format="markdown" if chosen in verbs() else "plaintext",  # whose renderer is not worth its import
        suppress_keyboard_interrupt=False,
    )
    for verb, about in verbs().items():
        # The help of the chosen verb is its own docstring, which says more.
        file, _ = _FILES.get(verb, ("questions", ""))
        called = f"gbeam.cli.{file}:{verb.replace('-', '_')}"
        app.command(called, name=verb, help=None if verb == chosen else about)
    app.register_install_completion_command(help="Let the shell complete verbs and options: bash, zsh or fish.")
    return app

"""Parser of the command line, and the exit status of errors that a verb raises."""

from __future__ import annotations

import os
from collections.abc import Callable
from inspect import BoundArguments

# A beam's matrices are small: threads of OpenBLAS, started as NumPy and SciPy are imported, would only spin.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
# Reading a scenario needs no plugin, and the search for plugins takes as long as the reading.
os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")

from cyclopts import App, ArgumentCollection, CycloptsError

import gbeam
from gbeam.cli.failures import lacks_memory, report, report_defect, report_memory, report_syntax
from gbeam.cli.process import end_at_once, note
from gbeam.errors import GbeamError
from gbeam.guards.limits import WORDS
from gbeam.questions import QUESTIONS

# Module of each verb that is not made from a question, and its line in `gbeam --help`, which imports none of them; the
# line is empty where a question has it.
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
    "presets": ("files", "Tests of standards on a plain arm, with their figures and clauses."),
    "schema": ("files", "Print the JSON schema of scenario files, for editors."),
}
_INTERRUPTED = 130


def run(tokens: list[str]) -> int:
    """Run a verb, print its error, if any, and return the exit status."""
    as_json = "--json" in tokens
    if len(tokens) > WORDS:
        return report_syntax(f"The command line has {len(tokens)} words, and {WORDS} are read at most.", as_json)
    note(tokens)
    try:
        status = _app(tokens[0] if tokens else "")(
            _name_stdin(tokens), exit_on_error=False, print_error=False, result_action="return_value"
        )
    except CycloptsError as error:
        return report_syntax(str(error), as_json)
    except GbeamError as error:
        return report(error, as_json)
    except KeyboardInterrupt:  # only if called from Python: the command line's own process has ended
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
    """Function that a command line calls, and its arguments. ValueError if it calls none."""
    try:
        verb, bound, _ = _app(tokens[0] if tokens else "").parse_args(
            _name_stdin(tokens), exit_on_error=False, print_error=False
        )
    except CycloptsError as error:
        raise ValueError(str(error)) from None
    return verb, bound


def _name_stdin(tokens: list[str]) -> list[str]:
    """Arguments with a name for standard input, ``-``, which the parser would take for an option."""
    return ["<stdin>" if token == "-" else token for token in tokens]


def verbs() -> dict[str, str]:
    """Return every verb with its line in `gbeam --help`."""
    questions = {name: question.about for name, question in QUESTIONS.items()}
    return questions | {verb: line or questions[verb] for verb, (_, line) in _FILES.items()}


def function(verb: str) -> Callable[..., object]:
    """Return the function of a verb."""
    called = _app(verb)[verb].default_command
    assert called is not None
    return called


def arguments(verb: str) -> ArgumentCollection:
    """Return the arguments of a verb, with the help, choices and default of each."""
    return _app(verb)[verb].assemble_argument_collection()


def _app(chosen: str) -> App:
    """Parser of all verbs, for a command line that calls the verb `chosen`."""
    app = App(
        name="gbeam",
        help="How a flexible beam responds while its base moves a lot: in flight, on a centrifuge, on a hub.",
        version=gbeam.__version__,
        help_format="markdown" if chosen in verbs() else "plaintext",  # Markdown takes long to import
        suppress_keyboard_interrupt=False,
    )
    for verb, summary in verbs().items():
        # The help of the chosen verb is its own docstring, which says more.
        module, _ = _FILES.get(verb, ("questions", ""))
        function_path = f"gbeam.cli.{module}:{verb.replace('-', '_')}"
        app.command(function_path, name=verb, help=None if verb == chosen else summary)
    app.register_install_completion_command(help="Let the shell complete verbs and options: bash, zsh or fish.")
    return app

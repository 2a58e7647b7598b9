"""The arguments that verbs share."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

ScenarioFile = Annotated[Path, Parameter(help="Scenario file, TOML or JSON.")]
Overrides = Annotated[
    tuple[str, ...],
    Parameter(
        name="--set",
        negative="",
        show_default=False,
        help='Change the scenario, KEY=VALUE, such as "beam.length=250 mm"; any number of times.',
    ),
]
Out = Annotated[
    Path | None,
    Parameter(name="--out", help="Folder for the files. Without it run writes to out/NAME, with --json nowhere."),
]
Json = Annotated[
    bool, Parameter(name="--json", negative="", show_default=False, help="Print one JSON object and nothing else.")
]
IgnoreLimits = Annotated[
    bool,
    Parameter(
        name="--ignore-limits",
        negative="",
        show_default=False,
        help="Exit with 0 though a machine's limit is exceeded.",
    ),
]

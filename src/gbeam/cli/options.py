"""The arguments that verbs share."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from cyclopts import Parameter

from gbeam.cli.publication import refuse_unwritable
from gbeam.questions import QUESTIONS, differentiable

if TYPE_CHECKING:
    Verb = str
    _Smooth = str
else:
    Verb = Literal[tuple(QUESTIONS)]
    _Smooth = Literal[differentiable()]


def option(name: str, words: str) -> Parameter:
    """An option without an opposite, whose default is not worth a word in the help."""
    return Parameter(name=name, negative="", show_default=False, help=words)


# Of all verbs, or of many.
ScenarioFile = Annotated[Path, Parameter(help="Scenario file, TOML or JSON.")]
Overrides = Annotated[
    tuple[str, ...],
    option("--set", 'Change the scenario, KEY=VALUE, such as "beam.length=250 mm"; any number of times.'),
]
Out = Annotated[
    Path | None,
    Parameter(name="--out", help="Folder for the files. Without it run writes to out/NAME, with --json nowhere."),
]
Json = Annotated[bool, option("--json", "Print one JSON object and nothing else.")]
Report = Annotated[
    bool,
    option(
        "--report",
        "Also write the result as one page of HTML that opens without a network, with plots that zoom and the "
        "beam in motion; without --out into out/NAME.",
    ),
]


@Parameter(name="*")
@dataclass(frozen=True)
class Output:
    """Options of every verb that answers: the changes of its scenario, and how its answer is printed and written."""

    overrides: Overrides = ()
    out: Out = None
    json: Json = False
    report: Report = False

    def folder(self, scenario: Path, *, always: bool = False) -> Path | None:
        """The folder of --out, which can be written to; without it out/ and the scenario's name for a page, or always.

        With --json nothing is written that was not asked for.
        """
        default = self.report or (always and not self.json)
        folder = self.out if self.out is not None or not default else Path("out") / scenario.stem
        if folder is not None:
            refuse_unwritable(folder)
        return folder


MotionName = Annotated[
    str | None, Parameter(name="--motion", help="Which [motion.NAME]; may be left out where only one can answer.")
]
At = Annotated[
    str | None, Parameter(name="--at", help='Time at which the motion is frozen, such as "2 s"; by default the start.')
]
IgnoreLimits = Annotated[
    bool,
    option("--ignore-limits", "Exit with 0 though a machine's limit is exceeded."),
]

SmoothVerb = Annotated[_Smooth, Parameter(help="Whose figures.")]

# Of campbell and critical-speed.
Turns = Annotated[
    str | None,
    Parameter(name="--turning", help="Of a system, the angle that turns, base.angle; else its one prescribed angle."),
]

# Of critical-speed.
Vary = Annotated[
    Literal["rate", "loads", "acceleration"],
    Parameter(
        name="--vary",
        help="What is raised: the rate of the hub or joint; all loads on beams and points, by one factor, the base "
        "being frozen; or the acceleration of the root along the beam, which pushes it.",
    ),
]
To = Annotated[
    str | None,
    Parameter(name="--to", help='End of search, such as "20 rad/s"; by default ten times what the beam resists.'),
]
Masses = Annotated[str | None, Parameter(name="--masses", help='A map instead, with one more mass: "0.1 kg, 0.5 kg".')]
Positions = Annotated[
    str | None, Parameter(name="--positions", help='Where that mass sits: "2 m, 5 m, 8 m"; by default all along.')
]

# Of linearize.
Rate = Annotated[
    str | None, Parameter(name="--rate", help='A hub\'s steady rate in place of a time, such as "2 rad/s".')
]
ModesKept = Annotated[
    int | None,
    Parameter(name="--modes", help='Keep so many of the slowest modes, "4", besides what has no frequency; else all.'),
]
Balanced = Annotated[
    int | None,
    Parameter(name="--balanced", help='Keep so many states by balanced truncation, "6", besides what does not decay.'),
]
StrainAt = Annotated[
    tuple[str, ...],
    option("--strain-at", 'Strain at a station, "10 mm", on the faces towards +z and +y; any number of times.'),
]
Inputs = Annotated[
    str | None, Parameter(name="--inputs", help='Only these, "torque"; by default all. So with --outputs.')
]
Outputs = Annotated[str | None, Parameter(name="--outputs", help='Only these, "tip_y, hub_angle".')]

AtLoop = Annotated[
    str,
    Parameter(
        name="--loop",
        help="Of a system with controllers: open; closed, from sample to sample, with margins; or cut at a drive, "
        '"pointing: axis.angle".',
    ),
]

# Of campbell.
Speed = Annotated[
    str | None, Parameter(help='Such as "60 rpm"; by default from rest to the largest rate of the motion.')
]

# Of fit and optimize.
SearchBounds = Annotated[
    tuple[str, ...],
    option(
        "--bounds",
        'Of a value, "beam.damping_ratio=0.1 %:5 %", any number of times; else 0.1 to 10 times its own.',
    ),
]
Starts = Annotated[int, Parameter(help="Searches: one from the scenario's values, the others spread over the bounds.")]
WriteTo = Annotated[
    Path | None, Parameter(name="--write", help="A scenario to write, with the values found and its comments.")
]

# Of place.
Measure = Annotated[
    str,
    Parameter(help='root-shear, root-moment, vibration or tip; or a weighted sum, "tip=1, root-moment=0.5".'),
]
CentrifugeName = Annotated[str | None, Parameter(help="Which centrifuge, where the scenario has several.")]
Widths = Annotated[
    tuple[str, ...],
    option(
        "--smoothing",
        'Width of the kernel to keep, "60 ms"; given twice, the search goes from the one to the other. Without it '
        "from a quarter to four times the scenario's.",
    ),
]
Check = Annotated[
    bool, Parameter(name="--proof", negative="--no-proof", help="Check the answer by simulation with the model.")
]

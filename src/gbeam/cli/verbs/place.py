"""``gbeam place``: where to put the specimen on the centrifuge."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from gbeam.cli.common import number
from gbeam.cli.console import stdout
from gbeam.cli.inputs import Input, read
from gbeam.cli.options import IgnoreLimits, Json, Out, Overrides, ScenarioFile
from gbeam.cli.outputs import publish, refuse_unwritable
from gbeam.errors import InputError

if TYPE_CHECKING:
    from gbeam.analysis.imitation.place import Choice
    from gbeam.motion import Flight

Measure = Annotated[
    str,
    Parameter(help='root-shear, root-moment, vibration or tip; or a weighted sum, "tip=1, root-moment=0.5".'),
]
Motion = Annotated[str | None, Parameter(help="Which centrifuge, where the scenario has several.")]
Widths = Annotated[
    tuple[str, ...],
    Parameter(
        name="--smoothing",
        negative="",
        show_default=False,
        help='Width of the kernel to keep, "60 ms"; given twice, the search goes from the one to the other. Without it '
        "from a quarter to four times the scenario's.",
    ),
]
Proven = Annotated[
    bool, Parameter(name="--proof", negative="--no-proof", help="Prove the answer by the model's own response.")
]
MOUNTINGS = ("upright", "inverted")
_FACTOR = 4.0  # of the scenario's smoothing, either way


def place(
    scenario: ScenarioFile,
    /,
    *,
    measure: Measure = "tip",
    motion: Motion = None,
    smoothing: Widths = (),
    proof: Proven = True,
    overrides: Overrides = (),
    out: Out = None,
    json: Json = False,
    ignore_limits: IgnoreLimits = False,
) -> int:
    """Find the control point, mounting and smoothing that change the specimen's response least.

    Options that exceed the machine's limits are told but not chosen, unless --ignore-limits is given. With --out also
    writes place.json. Exit status: 0 done, 1 every option exceeds the limits, 2 the input is wrong.
    """
    weights = parse(measure)
    tried = [number("--smoothing", text, "time") for text in smoothing]
    if out is not None:
        refuse_unwritable(out)
    given = read("place", scenario, overrides)
    name = chosen(given, motion)

    from gbeam.analysis.imitation.place import check_weights
    from gbeam.analysis.imitation.place import place as best_place
    from gbeam.analysis.study.study import structure_of
    from gbeam.motion import Centrifuge, Flight
    from gbeam.report import as_json
    from gbeam.report.place import place_json, place_text

    check_weights(weights, "--measure")
    flight, current = given.case.motions[given.case.tracks[name]], given.case.motions[name]
    assert isinstance(flight, Flight) and isinstance(current, Centrifuge)  # the schema sees to it
    with given.placing():
        answer = best_place(
            structure_of(given.case),
            flight,
            choice(given, name, flight, tried, not ignore_limits),
            given.case.response,
            weights,
            current=current,
            names=(given.case.tracks[name], name),
            beam=given.case.beam if proof else None,
        )
    text = as_json(place_json(answer))
    if out is not None:
        publish(out, lambda hidden: Path(hidden / "place.json").write_text(text + "\n", encoding="utf-8"))
    if json:
        print(text)
    else:
        stdout().print(place_text(answer), markup=False, soft_wrap=True)
    return 0


def parse(measure: str) -> dict[str, float]:
    """Read a measure or a weighted sum of measures."""
    weights: dict[str, float] = {}
    for term in measure.split(","):
        name, _, weight = term.partition("=")
        try:
            weights[name.strip()] = float(weight) if weight else 1.0
        except ValueError:
            raise InputError(
                "--measure", f"has the weight {weight.strip()!r}", 'write "tip=1, root-moment=0.5"'
            ) from None
    return weights


def chosen(given: Input, name: str | None) -> str:
    """Name of the centrifuge asked for, or of the only one."""
    names = list(given.case.tracks)
    if not names:
        raise InputError("motion", "has no centrifuge", "add one that tracks the flight; `gbeam new` shows how")
    if name is None and len(names) > 1:
        raise InputError("--motion", f"is missing, and there are {len(names)}", f"choose of {', '.join(names)}")
    if name is not None and name not in names:
        raise InputError("--motion", f"names no centrifuge {name!r}", f"choose of {', '.join(names)}")
    return name or names[0]


def choice(given: Input, name: str, flight: Flight, tried: list[float], limited: bool) -> Choice:
    """Both mountings, the scenario's own first, and the widths asked for."""
    from gbeam.analysis.imitation.place import Choice
    from gbeam.motion import Centrifuge
    from gbeam.numerics.bounded_search import coarse
    from gbeam.scenario import schema
    from gbeam.scenario.build_motion import centrifuge_of

    own, settings = given.scenario.motion[name], given.case.response
    assert isinstance(own, schema.Centrifuge)
    if len(tried) > 2:
        raise InputError("--smoothing", f"is given {len(tried)} times", "give one width, or the ends of a range")
    if any(width <= 0 for width in tried) and len(tried) > 1:
        raise InputError("--smoothing", f"is {min(tried):g} s", "give two positive widths")
    ends = sorted(tried) or [own.smoothing / _FACTOR, own.smoothing * _FACTOR]
    widths = coarse(ends[0], ends[-1])
    span = (settings.start, settings.start + settings.duration)

    def make(mounting: str, width: float) -> Centrifuge:
        changed = own.model_copy(update={"mounting": mounting, "smoothing": width})
        return centrifuge_of(changed, flight, span)

    others = tuple(it for it in MOUNTINGS if it != own.mounting)
    return Choice(make, (own.mounting, *others), widths, len(widths) > 1, limited)

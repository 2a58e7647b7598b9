"""``gbeam place``: where to put the specimen on the centrifuge."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from gbeam.cli.console import stdout
from gbeam.cli.inputs import Input, read
from gbeam.cli.options import Json, Out, Overrides, ScenarioFile
from gbeam.cli.outputs import publish, refuse_unwritable
from gbeam.errors import InputError
from gbeam.scenario import ScenarioError, build, load

if TYPE_CHECKING:
    from gbeam.analysis.place import Candidate
    from gbeam.results_place import Placement

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
        help='Widths of the kernel to try, "40 ms", any number of times; else half, once and twice the scenario\'s.',
    ),
]
Proven = Annotated[
    bool, Parameter(name="--proof", negative="--no-proof", help="Prove the answer by the model's own response.")
]
MOUNTINGS = ("upright", "inverted")


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
) -> int:
    """Find the control point, mounting and smoothing that change the specimen's response least.

    With --out also writes place.json. Exit status: 0 done, 1 the computation failed, 2 the input is wrong.
    """
    weights = parse(measure)
    if out is not None:
        refuse_unwritable(out)
    given = read("place", scenario, overrides)
    name = chosen(given, motion)
    flight = given.case.motions[given.case.tracks[name]]

    from gbeam.analysis import structure_of
    from gbeam.analysis.place import place as best_place
    from gbeam.motion import Flight
    from gbeam.report import as_json

    assert isinstance(flight, Flight)  # the schema sees to it
    tried, refused = candidates(scenario, overrides, given, name, smoothing)
    with given.placing():
        answer = best_place(
            structure_of(given.case),
            flight,
            tried,
            given.case.response,
            weights,
            names=(given.case.tracks[name], name),
            beam=given.case.beam if proof else None,
        )
    text = as_json(told(answer, refused))
    if out is not None:
        publish(out, lambda hidden: Path(hidden / "place.json").write_text(text + "\n", encoding="utf-8"))
    if json:
        print(text)
    else:
        stdout().print(_lines(answer, refused), markup=False)
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


def candidates(
    file: Path, overrides: tuple[str, ...], given: Input, name: str, widths: tuple[str, ...]
) -> tuple[list[Candidate], list[str]]:
    """The scenario's own centrifuge and its variants, and why others could not be built."""
    from gbeam.analysis.place import Candidate
    from gbeam.motion import Centrifuge

    own = given.scenario.motion[name]
    width, mounting = float(getattr(own, "smoothing")), str(getattr(own, "mounting"))  # noqa: B009  # of any motion
    wanted = list(widths) or [f"{factor * width!r} s" for factor in (1.0, 0.5, 2.0)][: 3 if width else 1]
    first = given.case.motions[name]
    assert isinstance(first, Centrifuge)
    tried, refused = [] if widths else [Candidate(mounting, width, first)], []
    for way in (mounting, *(it for it in MOUNTINGS if it != mounting)):
        for text in wanted:
            if not widths and way == mounting and text == wanted[0]:
                continue
            changes = (f"motion.{name}.mounting={way}", f"motion.{name}.smoothing={text}")
            try:
                scenario = load(file, (*overrides, *changes))
                it = build(scenario).motions[name]
            except ScenarioError as error:
                refused.append(f"{way}, {text}: {error.diagnostics[0].message}")
                if widths and not tried:
                    raise
                continue
            assert isinstance(it, Centrifuge)
            tried.append(Candidate(way, float(getattr(scenario.motion[name], "smoothing")), it))  # noqa: B009
    return tried, refused


def told(answer: Placement, refused: list[str]) -> dict[str, Any]:
    """The answer for JSON, SI units; fractions are of flight's peaks."""
    best = answer.best
    return {
        "outcome": "done",
        "flight": answer.flight,
        "centrifuge": answer.centrifuge,
        "measure": dict(answer.weights),
        "control_point": best.control_point,
        "fraction_of_length": answer.fraction,
        "mounting": best.mounting,
        "smoothing": best.smoothing,
        "present_control_point": answer.present,
        "mismatch": {place: dict(values) for place, values in answer.values.items()},
        "options": [asdict(it) for it in answer.options],
        "proofs": {it.name: asdict(it) for it in answer.proofs},
        "vibration_gain_over_middle": answer.vibration_gain,
        "refused": refused,
    }


def _lines(answer: Placement, refused: list[str]) -> str:
    best = answer.best
    measure = " + ".join(f"{weight:g} {name}" for name, weight in answer.weights.items())
    lines = [
        f"{answer.centrifuge}, tracking {answer.flight}: least {measure}",
        f"  control point  {1e3 * best.control_point:.2f} mm from the root, {answer.fraction:.4f} of the length "
        f"(now {1e3 * answer.present:.2f} mm)",
        f"  mounting       {best.mounting}",
        f"  smoothing      {1e3 * best.smoothing:.4g} ms",
        "",
        "What the mismatch field does, of flight's peak" + " " * 10 + "best       present    middle",
    ]
    for name in answer.values["best"]:
        row = "".join(f"{100 * answer.values[place][name]:<9.3g}% " for place in ("best", "present", "middle"))
        lines.append(f"  {name:<54}{row}")
    if answer.proofs:
        lines += ["", "Proven by the model's response, against flight"]
        for it in answer.proofs:
            lines.append(
                f"  {it.name:<8} {1e3 * it.control_point:8.2f} mm: tip within {1e3 * it.tip_difference:.4g} mm, "
                f"vibration {1e3 * it.vibration:.3g} mm, root moment within {it.moment_difference:.3g} N m"
            )
        lines.append(f"  {answer.vibration_gain:.3g} times less vibration than with the control point at mid-span")
    lines += ["", "Options, best first"]
    for option in answer.options:
        peaks = ", ".join(f"{a:.3g}" for a in option.accelerations)
        lines.append(
            f"  {option.mounting}, {1e3 * option.smoothing:.4g} ms: {100 * option.whole:.3g} % at "
            f"{1e3 * option.control_point:.2f} mm; axis accelerations {peaks} rad/s²"
        )
    return "\n".join([*lines, *(f"  cannot: {it}" for it in refused)])

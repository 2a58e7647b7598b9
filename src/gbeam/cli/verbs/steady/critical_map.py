"""``gbeam critical-speed --masses``: critical hub rates against a mass on the beam and its position."""

from __future__ import annotations

from pathlib import Path

from gbeam.cli.inputs import Input, numbers
from gbeam.cli.outputs import show, write_json
from gbeam.cli.process import figures_wanted
from gbeam.cli.publication import publish
from gbeam.cli.terminal.console import Watch
from gbeam.errors import InputError


def critical_map(
    given: Input,
    motion: str | None,
    masses: str,
    positions: str | None,
    upper: float | None,
    out: Path | None,
    json: bool,
    report: bool,
) -> int:
    """Print and write the map; the arguments are those of :func:`~.critical_speed.critical_speed`."""
    name, chosen = given.motion(motion, kind="hub")
    case = given.case
    kilograms = numbers("--masses", masses, "mass")
    length = case.beam.length
    places = [length * i / 8 for i in range(1, 9)] if positions is None else numbers("--positions", positions, "length")
    if max(places) > length:
        raise InputError("--positions", f"has {max(places):g} m, off the beam", f"give 0 to {length:g} m")

    from gbeam.analysis.vibration.stability import critical_speed_map
    from gbeam.report.steady import critical as words
    from gbeam.results.declared import json_of

    with Watch() as watch, given.placing():
        critical = critical_speed_map(
            case.beam, case.model, chosen, kilograms, places, upper, name=name, progress=watch
        )
    facts = given.signed(json_of(critical))

    def make(hidden: Path) -> None:
        write_json(hidden / "critical_speed.json", facts)
        (hidden / "critical_speed.csv").write_text(words.map_csv(critical), encoding="utf-8")
        if report:
            from gbeam.report.page.document import html

            (hidden / "critical_speed.html").write_text(html(facts, {}), encoding="utf-8")
        if figures_wanted():
            from gbeam.plots import save

            save(critical.plot(title=case.title).figure, hidden, "critical_speed", "gbeam critical-speed")

    if out is not None:
        publish(out, make)
    show(words.map_text(critical), facts, json)
    return 0

"""``gbeam critical-speed``: the hub rate, load or acceleration at which the beam's equilibrium is lost."""

from __future__ import annotations

from gbeam.cli.inputs import number, read
from gbeam.cli.options import At, Json, Masses, MotionName, Out, Overrides, Positions, Report, ScenarioFile, To, Vary
from gbeam.cli.outputs import folder_of, show, write
from gbeam.cli.terminal.console import Watch
from gbeam.cli.verbs.steady.critical_map import critical_map
from gbeam.errors import InputError

KINDS = {"rate": "angular rate", "loads": "ratio", "acceleration": "acceleration"}


def critical_speed(
    scenario: ScenarioFile,
    /,
    *,
    motion: MotionName = None,
    vary: Vary = "rate",
    at: At = None,
    to: To = None,
    masses: Masses = None,
    positions: Positions = None,
    overrides: Overrides = (),
    out: Out = None,
    json: Json = False,
    report: Report = False,
) -> int:
    """The hub rate, load or acceleration at which the beam's equilibrium is lost.

    Where there is none up to the end of the search, the value is null and the reason says so; that is an answer, with
    exit status 0. 2: the input is wrong, such as a motion without a hub. With --out writes critical_speed.json, and a
    map also as CSV and plot; with --report also critical_speed.html.
    """
    folder = folder_of(out, scenario, default=report)
    given = read("critical-speed", scenario, overrides, folder)
    upper = None if to is None else number("--to", to, KINDS[vary])
    if upper is not None and not upper > 0:
        raise InputError("--to", f"is {to}", "give a value above zero, where the search ends")
    if masses is None and positions is not None:
        raise InputError("--positions", "stands without --masses", 'add --masses "0.1 kg, 0.5 kg"')
    if masses is not None:
        if vary != "rate":
            raise InputError("--masses", f"stands beside --vary {vary}", "a map is of hub rates")
        return critical_map(given, motion, masses, positions, upper, folder, json, report)
    name, chosen = given.motion(motion, kind="hub")
    time = given.time(at)

    from gbeam.analysis.equilibrium.point import held_base
    from gbeam.analysis.vibration import stability
    from gbeam.report.steady import critical as words

    with Watch() as watch, given.placing():
        structure = given.case.assemble().at_time(time)
        if vary == "rate":
            critical = stability.critical_speed(structure, chosen, upper=upper, name=name, progress=watch)
        elif vary == "loads":
            critical = stability.critical_load(structure, held_base(chosen, time), upper=upper, progress=watch)
        else:
            critical = stability.buckling_acceleration(structure, upper=upper, progress=watch)
    facts = given.signed(words.to_json(critical, name))
    write(folder, "critical_speed", facts, report=report)
    show(words.text(critical, name), facts, json)
    return 0

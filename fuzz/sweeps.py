"""Sweeps: what varies, what is measured and how samples are drawn, on the command line and in a [sweep] table."""

from __future__ import annotations

import re
import tomllib
from typing import Any

from fuzz.cases import ROOT, Case, Random
from fuzz.scenarios import NUMBERS, ODD, UNITS, WORDS, change, corrupted, toml

SCENARIOS = ("hubbeam2009_slew_3", "hubbeam2009_torque_50", "zhang2020_example1")
# Sound in the first of them, and of few cases.
OVER = (
    "motion.slew.radius=0.1 m:1 m:3", "beam.length=7 m, 8 m", "model.kind=FOAM, TLAM", "beam.length=log(1 m:10 m:3)",
    "beam.material.youngs_modulus=normal(70 GPa, 2 GPa)", "beam.damping_ratio=uniform(0.5 %, 2 %)",
    "beam.material.density=lognormal(2700 kg/m^3, 0.05)",
    "motion.slew.rate.level=triangular(1 rad/s, 2 rad/s, 4 rad/s)",
    "model.modes.y=1, 2", "beam.masses[0].mass=0 kg:1 kg:2",
)  # fmt: skip
MEASURES = {
    "static": ("tip.y", "slew.tip.x", "strain_energy", "stable", "errors.displacement.total"),
    "modes": ("modes[0].frequency", "modes[1].damping_ratio", "modes"),
    "critical-speed": ("critical_speed", "searched_to", "kind"),
    "plan": ("axis2.acceleration.used", "tip.y"),
}
PIECES = ("normal(", "uniform(1,2", "log(", ")", ":", "::", ",", ",,", "=", "[0]", "[-1]", "[", "1:2", "1:2:1e9", "-")
SAMPLERS = ("sobol", "latin", "random", "saltelli")


def sweep(chosen: Random) -> Case:
    """A sweep with a mistake or a few, or none."""
    text = (ROOT / "examples" / f"{chosen.choices(SCENARIOS, (6, 1, 1))[0]}.toml").read_text()
    words = ["sweep", "s.toml", "--out", "out"]
    files = {f"data/{each.name}": each.read_bytes() for each in (ROOT / "examples" / "data").glob("*.csv")}
    files = files if ".csv" in text else {}
    if chosen.random() < 0.4:
        data = tomllib.loads(text)
        data["sweep"] = _table(chosen)
        for _ in range(chosen.choice((0, 1, 1, 2))):
            table = data.get("sweep")  # a change before may have renamed or removed it
            change(chosen, table if isinstance(table, dict) and chosen.random() < 0.8 else data)
        changed = toml(data).encode("utf-8", "surrogatepass")
        if chosen.random() < 0.2:
            changed = corrupted(chosen, changed)
    else:
        changed = text.encode()
        verb = chosen.choices(list(MEASURES), (5, 2, 2, 1))[0]
        for _ in range(chosen.choice((0, 1, 1, 1, 1, 2, 3))):
            words.append(f"--over={_wrong(chosen, chosen.choice(OVER))}")
        for _ in range(chosen.choice((0, 1, 1, 1, 1, 2))):
            words.append(f"--measure={_wrong(chosen, chosen.choice(MEASURES[verb]))}")
        words.append(f"--verb={verb}")
    for _ in range(chosen.choice((0, 0, 1, 2))):
        words.append(_option(chosen))
    drawn = any("(" in word and "log(" not in word for word in words)
    if drawn and not any("--samples" in word for word in words):
        words.append("--samples=4")
    if b"verb" not in changed and not any("--verb" in word for word in words):
        words.append("--verb=static")
    # The system passes no null character.
    return Case("sweep", [word.replace("\0", "\\0") for word in words], {"s.toml": changed, **files})


def _table(chosen: Random) -> dict[str, Any]:
    over = dict(each.split("=", 1) for each in chosen.sample(OVER, chosen.choice((0, 1, 2, 3))))
    verb = chosen.choice(("static", "modes", "critical-speed"))
    table: dict[str, Any] = {
        "over": over,
        "measure": chosen.sample(MEASURES[verb], chosen.choice((0, 1, 2))),
        "verb": verb,
    }
    extra = {"samples": 4, "sampler": chosen.choice(SAMPLERS), "seed": 1, "history": ["slew.tip.y"]}
    for name in chosen.sample(sorted(extra), chosen.choice((0, 1, 2))):
        table[name] = extra[name]
    return table


def _option(chosen: Random) -> str:
    name, sound = chosen.choice(
        (
            ("samples", "4"), ("sampler", chosen.choice(SAMPLERS)), ("seed", "1"), ("times", "11"), ("motion", "slew"),
            ("at", "1 s"), ("history", "slew.tip.y"), ("workers", "1"), ("set", "response.duration=0.2 s"),
            ("resume", ""), ("netcdf", ""), ("json", ""),
        )
    )  # fmt: skip
    if not sound:
        return f"--{name}"
    value = sound if chosen.random() < 0.4 else str(chosen.choice((*NUMBERS, *WORDS, *ODD)))
    if name == "workers" and re.fullmatch(r"[2-9]|\d\d", value):  # processes are no business of a process with limits
        value = "0"
    return f"--{name}={value[:2000]}"


def _wrong(chosen: Random, text: str) -> str:
    """The text as it is, or with a piece put in, taken out or replaced."""
    if chosen.random() < 0.6:
        return text
    first = chosen.randrange(len(text) + 1)
    last = min(len(text), first + chosen.choice((0, 1, 1, 3, 10)))
    number, unit, word = chosen.choice(NUMBERS), chosen.choice(UNITS), chosen.choice(WORDS)
    match chosen.randrange(5):
        case 0:
            return text[:first] + text[last:]
        case 1:
            return text[:first] + chosen.choice(PIECES) + text[last:]
        case 2:
            return text.partition("=")[0] + f"={number} {unit}"
        case 3:
            return re.sub(r"\d+", lambda each: str(number) if chosen.random() < 0.5 else each[0], text)
    return text[:first] + str(word) + text[last:]

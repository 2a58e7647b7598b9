"""Command lines: verbs, options and values that do not fit together."""

from __future__ import annotations

from fuzz.cases import ROOT, Case, Random
from fuzz.scenarios import NUMBERS, UNITS, WORDS, texts
from gbeam.cli import verbs

# Options of one verb or another, each with a sound value; a flag has none.
OPTIONS: dict[str, str | None] = {
    "--set": "beam.length=250 mm", "--out": "out", "--json": None, "--motion": "slew", "--at": "0.1 s",
    "--ignore-limits": None, "--vary": "rate", "--to": "20 rad/s", "--masses": "0.1 kg, 0.5 kg",
    "--positions": "2 m, 5 m", "--rate": "2 rad/s", "--modes": "2", "--balanced": "2", "--strain-at": "10 mm",
    "--inputs": "torque", "--outputs": "tip_y", "--speed": "60 rpm", "--measure": "tip=1", "--smoothing": "60 ms",
    "--no-proof": None, "--sample": "5 ms", "--kind": "hub", "--markdown": None, "--help": None, "--version": None,
    "--write": None, "--of": "tip.y", "--with": "beam.length", "--minimise": "tip.y", "--subject-to": "limits",
    "--over": "beam.length=1 m:2 m", "--bounds": "beam.length=1 m:2 m", "--verb": "static", "--starts": "1",
    "--angle": "1 rad", "--duration": "2 s", "--limit": "45 N m", "--robust": "10 %", "--check": "FOAM",
    "--data": "s.toml", "--free": "beam.length", "--report": None, "--samples": "2", "--seed": "1", "--resume": None,
}  # fmt: skip
# Sound words of the verbs that compute longer; one of them changes.
STUDIES = {
    "run": ["--set", "response.duration=0.05 s"],
    "models": ["--set", "response.duration=0.05 s", "--set", "model.kind=FOAM"],
    "place": ["--no-proof"],
    "sensitivity": ["--of", "tip.y", "--with", "beam.length", "--verb", "static"],
    "optimize": ["--minimise", "tip.y", "--over", "beam.length=7 m:8 m", "--verb", "static", "--starts", "1"],
    "fit": ["--data", "d.csv", "--free", "beam.material.youngs_modulus", "--starts", "1"],
    "shape": ["--angle", "0.1 rad", "--duration", "2 s"],
    "sweep": ["--over", "beam.length=7 m, 8 m", "--measure", "tip.y", "--verb", "static", "--out", "out"],
}
MEASURED = b"mode,frequency [Hz]\n1,1.1\n2,6.5\n"
KEYS = [
    "beam.length", "beam", "model.modes.y", "model.modes", "model", "motion.slew.radius", "beam.masses[0].at",
    "beam[0]", "title", "response.duration", "response.step", "a.b.c", "motion.x.kind", "", ".", "beam..length",
    "beam.section.width[0]",
]  # fmt: skip
QUICK = ("check", "static", "modes", "campbell", "critical-speed", "linearize", "new", "schema", "plan")


def command(chosen: Random) -> Case:
    """A command line of sound and wrong words."""
    if chosen.random() < 0.15:
        return _study(chosen)
    verb = chosen.choice(
        QUICK if chosen.random() < 0.9 else (*WORDS, "rnu", *(each for each in verbs() if each != "app"))
    )
    words = [verb]
    if chosen.random() < 0.9:
        words.append("s.toml" if chosen.random() < 0.8 else chosen.choice((*WORDS, "t.toml", "s.tml", "-", "new.toml")))
    for _ in range(chosen.choice((0, 1, 1, 2, 3))):
        option, value = chosen.choice(list(OPTIONS.items()))
        if option == "--set" and chosen.random() < 0.8:
            value = f"{chosen.choice(KEYS)}={_value(chosen)}"
        elif value is not None and chosen.random() < 0.6:
            value = _value(chosen)
        words += [option] if value is None else [f"{option}={value}"] if chosen.random() < 0.2 else [option, value]
    if chosen.random() < 0.1:
        chosen.shuffle(words)
    if chosen.random() < 0.1:
        del words[chosen.randrange(len(words))]
    if "place" in words or "run" in words or "models" in words:  # what is still valid is to end soon
        words = ["check", *words[1:]]
    text = chosen.choice(texts()[1:6] + texts()[-1:])
    # The system passes no null character.
    return Case("command", [word.replace("\0", "\\0") for word in words], {"s.toml": text.encode()})


def _study(chosen: Random) -> Case:
    """A verb that computes longer, with a word or two changed, left out or too much."""
    verb = chosen.choice(list(STUDIES))
    words = list(STUDIES[verb])
    for _ in range(chosen.choice((1, 1, 2))):
        option, value = chosen.choice(list(OPTIONS.items()))
        match chosen.randrange(4):
            case 0:
                words[chosen.randrange(len(words))] = _value(chosen)
            case 1:
                first = chosen.randrange(len(words))
                del words[first : first + 2]
            case 2:
                words += [f"--set={chosen.choice(KEYS)}={_value(chosen)}"]
            case _:
                words += [option] if value is None else [option, chosen.choice((value, _value(chosen)))]
        if not words:
            break
    example = "zhang2020_example1" if verb == "place" else "hubbeam2009_slew_3"
    files = {"s.toml": (ROOT / "examples" / f"{example}.toml").read_bytes(), "d.csv": MEASURED}
    return Case("command", [verb, "s.toml", *(word.replace("\0", "\\0") for word in words)], files)


def _value(chosen: Random) -> str:
    match chosen.randrange(5):
        case 0:
            return str(chosen.choice(WORDS))
        case 1:
            return str(chosen.choice(NUMBERS))
        case 2:
            return f"{chosen.choice(NUMBERS)} {chosen.choice(UNITS)}"
        case 3:
            return chosen.choice(
                ("{", "[", "[" * 100, "{a=1}", "[1,2]", "{a={b={c=1}}}", "1,,2", ",", "=", "a=b=c", "'''", "1979-05-27")
            )
    return f"{chosen.random() * 10 ** chosen.randrange(-9, 9):g} {chosen.choice(UNITS)}"

"""Scenarios: the examples, the templates and systems, with keys, values, units, nesting, types or bytes changed."""

from __future__ import annotations

import json
import math
import re
import tomllib
from copy import deepcopy
from functools import cache
from typing import Any

from fuzz.cases import ROOT, Case, Random
from gbeam.guards import KINDS, USUAL
from gbeam.scenario import template

UNITS = sorted({unit for kind in KINDS.values() for unit in (kind.unit, kind.example.split(" ", 1)[-1])})
UNITS += [unit for known in USUAL.values() for unit in known] + [
    "m^9^9",
    "m^-9",
    "%%",
    "1/s^2",
    "°",
    "µm",
    "furlong",
    "Hz^9",
]
NUMBERS: list[Any] = [
    0, -1, 1, 2, 3, 1000, 10**9, 10**30, -(10**18), 10**399, 0.0, -0.0, 0.5, 1e-300, 5e-324, 1e300, -1e308,
    math.inf, -math.inf, math.nan,
]  # fmt: skip
WORDS = [
    "", " ", "0", "1", "-1", "auto", "nan", "inf", "1e999 m", "300", "300 mm mm", "3 00 mm", "١ mm", "1_000 mm",
    "1,5 m", "x" * 300, "\x1b[31mred", "\x00", "\u202ereversed", "$a_b^$", "[bold]", "[/x]", "{value}",
    "{beam.length}", "%s", "../../etc/passwd", "/dev/zero", "/", ".", "con", "a\nb", "'", '"', "\\", "true", "none",
    "0x10 m", "-0 mm", "--1 mm", "1 m # note",
]  # fmt: skip
ODD: list[Any] = [True, False, [], {}, [[]], [{}], {"": 1}, [1, "a", None], {"x": {"y": {"z": {}}}}]
BYTES = [
    b"\x00", b"\x1b", b"\xff", b"\xef\xbb\xbf", b"\xed\xa0\x80", b"\r", b"\n\n", b"[", b"]" * 40, b"[" * 40, b"{",
    b"}", b"=", b'"', b'"""', b"'''", b"#", b",", b".", b"\xe2\x80\xae", b"9" * 500, b"a." * 40, b"[[", b"]]",
    b"1979-05-27T07:32:00Z", b"\t",
]  # fmt: skip
VERBS = ["check"] * 40 + [*(["static", "modes", "linearize", "campbell", "critical-speed", "plan"] * 3), "run"]


@cache
def texts() -> tuple[str, ...]:
    """The examples and the templates, small enough to be computed in a moment."""
    examples = [path.read_text() for path in sorted((ROOT / "examples").glob("*.toml"))]
    return (*examples, template("flight"), template("hub"))


@cache
def trees() -> tuple[str, ...]:
    """Systems of bodies, each with the files of the examples beside it."""
    files = sorted((ROOT / "fuzz" / "trees").glob("*.toml"))
    return tuple(path.read_text(encoding="utf-8").replace("../../examples/", "") for path in files)


def scenario(chosen: Random) -> Case:
    """A scenario with one change or a few."""
    text = chosen.choice(texts() if chosen.random() < 0.6 else trees())
    data = tomllib.loads(text)
    files = {}
    if chosen.random() < 0.6:
        for _ in range(chosen.choice((1, 1, 1, 2, 3))):
            change(chosen, data)
        as_json = chosen.random() < 0.3
        changed = (json.dumps(data) if as_json else toml(data)).encode("utf-8", "surrogatepass")
    else:
        changed = text.encode()
        for _ in range(chosen.choice((1, 1, 2, 5))):
            changed = corrupted(chosen, changed)
    verb = chosen.choice(VERBS)
    arguments = [verb, "s.toml"]
    if verb == "run":  # what is still valid is to end soon
        part = "motion.flight.record.to" if b".csv" in changed else "response.duration"
        arguments += ["--set", f"{part}=0.2 s", "--out", "out"]
    elif chosen.random() < 0.2:
        arguments += ["--json"]
    for file in (ROOT / "examples" / "data").iterdir():
        if f"data/{file.name}".encode() in changed:
            files[f"data/{file.name}"] = file.read_bytes()
    return Case("scenario", arguments, {"s.toml": changed, **files})


def corrupted(chosen: Random, text: bytes) -> bytes:
    """The bytes with a stretch taken out, doubled, moved or replaced."""
    if not text:
        return chosen.choice(BYTES)
    first = chosen.randrange(len(text))
    last = min(len(text), first + chosen.choice((1, 1, 2, 5, 20, 200)))
    match chosen.randrange(7):
        case 0:
            return text[:first] + text[last:]
        case 1:
            return text[:last] + text[first:]
        case 2:
            return text[:first] + chosen.choice(BYTES) + text[first:]
        case 3:
            return text[:first] + chosen.choice(BYTES) + text[last:]
        case 4:
            return text[:first]
        case 5:
            return text[:first] + bytes([chosen.randrange(256)]) + text[first + 1 :]
    lines = text.split(b"\n")
    i, j = chosen.randrange(len(lines)), chosen.randrange(len(lines))
    lines[i], lines[j] = lines[j], lines[i] if chosen.random() < 0.5 else lines[j]
    return b"\n".join(lines)


def change(chosen: Random, data: dict[str, Any]) -> None:
    """Change one entry, in place."""
    places = list(_places(data))
    if not places:
        data["x"] = 1
        return
    node, key = chosen.choice(places)
    other, another = chosen.choice(places)
    match chosen.randrange(12):
        case 0:
            del node[key]
        case 1 if isinstance(node, dict):
            node[_misspelt(chosen, str(key))] = node.pop(key)
        case 2:
            node[key] = deepcopy(other[another])
        case 3:
            node[key] = chosen.choice(NUMBERS)
        case 4:
            node[key] = chosen.choice(WORDS)
        case 5:
            node[key] = deepcopy(chosen.choice(ODD))
        case 6:
            node[key] = [deepcopy(node[key])] * chosen.choice((1, 2, 3, 2000))
        case 7:
            for _ in range(chosen.choice((1, 2, 50, 150))):
                node[key] = [node[key]] if chosen.random() < 0.5 else {"a": node[key]}
        case 8 if isinstance(node, dict):
            node[chosen.choice(WORDS) or "x"] = deepcopy(other[another])
        case 9 | 10:
            node[key] = _other_quantity(chosen, node[key])
        case _:
            node[key] = f"{chosen.choice(NUMBERS)} {chosen.choice(UNITS)}"[:2000]


def _places(node: Any) -> list[tuple[Any, Any]]:
    steps = node.items() if isinstance(node, dict) else enumerate(node) if isinstance(node, list) else ()
    places = []
    for key, value in steps:
        places += [(node, key), *_places(value)]
    return places


def _misspelt(chosen: Random, key: str) -> str:
    i = chosen.randrange(len(key) + 1)
    wrong = (key[:i] + key[i + 1 :], key[:i] + "x" + key[i:], key.upper(), key + " ", key * 30, f"{key}.{key}", "")
    return chosen.choice(wrong)


def _other_quantity(chosen: Random, value: Any) -> Any:
    match = re.fullmatch(r"([-+0-9.e]+) (.+)", value) if isinstance(value, str) else None
    if match is None:
        return -value if isinstance(value, (int, float)) else chosen.choice(NUMBERS)
    number, unit = match.groups()
    match chosen.randrange(4):
        case 0:
            return f"{float(number) * 10.0 ** chosen.choice((-300, -20, -6, -3, 3, 6, 20, 300)):g} {unit}"
        case 1:
            return f"{number} {chosen.choice(UNITS)}"
        case 2:
            return f"-{number} {unit}"
    between, after = ("", " ", "  ", "*", "^", "/", "·"), ("", "^2", "/s", "²", "⁹⁹", " )", " m")
    return f"{number}{chosen.choice(between)}{unit}{chosen.choice(after)}"


def toml(data: dict[str, Any]) -> str:
    """Write TOML, every table inline."""
    return "".join(f"{_key(key)} = {_value(value)}\n" for key, value in data.items())


def _key(key: str) -> str:
    return key if re.fullmatch(r"[A-Za-z0-9_-]+", key) else json.dumps(key)


def _value(value: Any) -> str:
    if isinstance(value, dict):
        return "{" + ", ".join(f"{_key(key)} = {_value(each)}" for key, each in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(_value, value)) + "]"
    if isinstance(value, float):
        return repr(value)
    if isinstance(value, (str, bool, int)):
        return json.dumps(value)
    return "null"

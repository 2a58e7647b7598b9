"""Foreign text made safe to show on a terminal, in a file or a figure; and suggestions for a misspelt name."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable

# Control characters but tab and line feed, C1's included; lone surrogates; marks that reverse the direction of writing.
_UNPRINTABLE = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff]")
_NOT_STORABLE = re.compile("[\0\ud800-\udfff]")
_EXPONENTS = str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻")
LEAST_SHARE = 1e-5  # that is printed as a number: what is smaller is "< 0.001 %"
MOST_TURNS = 2  # that are told in degrees: an angle of more is told in turns
LONGEST = 200  # characters of one value in a message


def printable(text: str) -> str:
    """Return the text with control characters, which a terminal would obey, as escapes, ``\\x1b`` for ESC."""
    return _UNPRINTABLE.sub(_escaped, text)


def storable(text: str) -> str:
    """Return the text with null characters and lone surrogates, which no text file can hold, as escapes."""
    return _NOT_STORABLE.sub(_escaped, text)


def raised(unit: str) -> str:
    """Return a unit with its exponents as they are printed, rad/s² for rad/s^2."""
    return re.sub(r"\^(-?\d+)", lambda power: power[1].translate(_EXPONENTS), unit)


def percent(share: float) -> str:
    """Write a share in percent: ``1.3 %``, ``110 %``; ``< 0.001 %`` and ``over 1000 %``, where digits say nothing."""
    if not math.isfinite(share):
        return "–"
    if 0 < share < LEAST_SHARE:
        return f"< {100 * LEAST_SHARE:g} %"
    return "over 1000 %" if share > 10 else f"{100 * share:{'.0f' if share > 0.1 else '.2g'}} %"


def on_one_line(text: str) -> str:
    """Return printable text without line feeds and tabs: a name or a value in a message of one line."""
    return printable(text).replace("\n", "\\n").replace("\t", "\\t")


def unprintable(text: str) -> str:
    """Return the escape of the first character that :func:`printable` would escape, or empty if there is none."""
    match = _UNPRINTABLE.search(text)
    return "" if match is None else _escaped(match)


def json_printable(text: str) -> str:
    """Return JSON with control characters, which stand only inside its strings, as escapes of JSON."""
    return _UNPRINTABLE.sub(lambda match: f"\\u{ord(match[0]):04x}", text)


def shortened(text: str, longest: int = LONGEST) -> str:
    """Return the text, or its beginning and end if it has more than `longest` characters."""
    half = longest // 2
    return text if len(text) <= longest else f"{text[:half]} … {text[-half:]}"


def _escaped(match: re.Match[str]) -> str:
    code = ord(match[0])
    return f"\\x{code:02x}" if code < 0x100 else f"\\u{code:04x}"


def closest(word: str, choices: Iterable[str]) -> str | None:
    """Return the choice that `word` was probably meant to be, or None. Case does not count."""
    from difflib import get_close_matches  # needed only where something is wrong

    lowered: dict[str, str] = {}
    for choice in choices:
        lowered.setdefault(choice.lower(), choice)
    matches = get_close_matches(word.lower(), lowered, n=1, cutoff=0.6)
    return lowered[matches[0]] if matches else None


def advise(word: str, choices: Iterable[str], *, listed: str = "choose one of") -> str:
    """Return ``did you mean 'thickness'?``, or the list of choices when none is near."""
    possible = list(choices)
    match = closest(word, possible)
    return f"did you mean {match!r}?" if match else f"{listed} {', '.join(possible)}"


def level_words(name: str, scale: float | None) -> str:
    """Name of a motion with the level factor of its loads: ``flight × 1.25``."""
    return name if scale in (None, 1) else f"{name} × {scale:.6g}"

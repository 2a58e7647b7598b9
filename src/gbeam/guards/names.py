"""Suggestions for a misspelt name."""

from __future__ import annotations

from collections.abc import Iterable


def closest(word: str, choices: Iterable[str]) -> str | None:
    """Return the choice that `word` was probably meant to be, or None; case does not count."""
    from difflib import get_close_matches  # needed only where something is wrong

    lowered: dict[str, str] = {}
    for choice in choices:
        lowered.setdefault(choice.lower(), choice)
    near = get_close_matches(word.lower(), lowered, n=1, cutoff=0.6)
    return lowered[near[0]] if near else None


def advise(word: str, choices: Iterable[str], *, listed: str = "choose one of") -> str:
    """Return ``did you mean 'thickness'?``, or the list of choices when none is near."""
    possible = list(choices)
    near = closest(word, possible)
    return f"did you mean {near!r}?" if near else f"{listed} {', '.join(possible)}"

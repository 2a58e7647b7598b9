"""The advice that ends a message about a word that is not known."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches


def closest(word: str, choices: Iterable[str]) -> str | None:
    """Return the choice that `word` was probably meant to be, or None; case does not count."""
    lowered: dict[str, str] = {}
    for choice in choices:
        lowered.setdefault(choice.lower(), choice)
    found = get_close_matches(word.lower(), lowered, n=1, cutoff=0.6)
    return lowered[found[0]] if found else None


def advise(word: str, choices: Iterable[str], *, listed: str = "choose one of") -> str:
    """Return ``did you mean 'thickness'?``, or the list of choices when none is near.

    Parameters
    ----------
    word : str
        What was written.
    choices : iterable of str
        What could have been written.
    listed : str
        How the list of choices begins.
    """
    known = list(choices)
    near = closest(word, known)
    return f"did you mean {near!r}?" if near else f"{listed} {', '.join(known)}"

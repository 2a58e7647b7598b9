"""Every result in words for people, as `text` says them; `facts` is the JSON, with the sentences of these words."""

from __future__ import annotations

import re
from importlib import import_module
from typing import TYPE_CHECKING, Any

from gbeam.report.words import as_json

if TYPE_CHECKING:
    from rich.console import RenderableType

__all__ = ["as_json", "text"]
# Kinds by the module that has a function of their name; of others every quantity is listed.
_MODULES = {
    "cases": ("Sweep", "Sensitivity", "Fit", "Optimum", "ShapedCommand"),
    "machine": ("Placement",),
    "steady": ("Deflection", "Modes", "Campbell", "Critical", "CriticalMap", "StateSpace", "SystemRest", "SystemModes"),
    "study": ("SystemResponse",),
    "tables": ("Study", "SystemStudy", "ModelStudy", "MachinePlan"),
}


def text(answer: Any, **more: Any) -> str | RenderableType:
    """Return an answer, or several of one kind, in words; of what fills a terminal's width what rich prints."""
    kind = type(answer[0] if isinstance(answer, tuple) else answer).__name__
    module = next((name for name, kinds in _MODULES.items() if kind in kinds), None)
    if module is None:
        return _listed(answer)
    name = re.sub(r"(?<!^)(?=[A-Z])", "_", kind).lower()
    words: str | RenderableType = getattr(import_module(f"gbeam.report.{module}"), name)(answer, **more)
    return words


def _listed(answer: Any) -> str:
    """Numbers and words of an answer, each on a line with what it is."""
    from gbeam.report.words import number
    from gbeam.results.declared import declarations

    lines = [(type(answer).__doc__ or "").partition("\n")[0]]
    for name, each in declarations(type(answer)):
        value, unit = getattr(answer, name), each.unit(answer) if callable(each.unit) else str(each.unit)
        if isinstance(value, (bool, str)):
            lines.append(f"  {each.words}: {value}")
        elif getattr(value, "ndim", 0) == 0 and isinstance(value, (int, float)):
            lines.append(f"  {each.words}: {number(value)} {unit}".rstrip())
    return "\n".join([*lines, *(f"warning: {each}" for each in answer.warnings)])

"""The viewer in a notebook."""

from __future__ import annotations

import json
from importlib.resources import files
from typing import Any

from gbeam.errors import InputError
from gbeam.report.page.result import shown
from gbeam.results.result import Result


def widget(result: Result) -> Any:
    """Return the viewer of a result as a widget of Jupyter."""
    header, numbers = shown(result)
    try:
        import anywidget
        import traitlets
    except ModuleNotFoundError:
        fix = "pip install 'gbeam[notebook]'; report(path) needs nothing"
        raise InputError("view", "needs the package anywidget, which is not installed", fix) from None
    assets = files("gbeam.report.page") / "assets"

    class Viewer(anywidget.AnyWidget):
        """The beam in motion."""

        _esm = (assets / "gbeam.js").read_text(encoding="utf-8")
        _css = (assets / "gbeam.css").read_text(encoding="utf-8")
        header = traitlets.Unicode().tag(sync=True)
        numbers = traitlets.Bytes().tag(sync=True)

    return Viewer(header=json.dumps(header, allow_nan=False), numbers=numbers.array.tobytes())

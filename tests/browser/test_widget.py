"""The widget of notebooks, drawn by the same module as reports, in headless Chromium."""

from __future__ import annotations

import base64
import json
from importlib.resources import files
from typing import Any

import numpy as np

import gbeam as gb
from gbeam.report import viewer_data
from gbeam.results import Outline

from ..plots.conftest import study
from ..responses import clamped

__all__ = ["study"]

DRAW = """async ([module, header, numbers]) => {
  const {default: widget} = await import(module);
  const bytes = Uint8Array.from(atob(numbers), c => c.charCodeAt(0));
  const values = {header, numbers: new DataView(bytes.buffer)};
  const el = document.body.appendChild(document.createElement("div"));
  window.dispose = widget.render({model: {get: name => values[name]}, el});
  await new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)));
}"""


def test_widget_shows_a_response(browser: Any, study: gb.Study) -> None:
    flight = study.responses["flight"]
    points = np.linspace(0, 0.3, 4)
    displacement = np.linspace(0, 0.1, 5)[:, None, None] * points[:, None] * [0, 0, 1.0]
    outline = Outline(
        points, np.full(4, 0.02), np.full(4, 0.004), False, np.array([[0.3, 0.1]]), flight.time[::50], displacement
    )
    header, numbers = viewer_data(clamped(flight, outline))
    module = (files("gbeam.report.page") / "assets" / "gbeam.js").read_bytes()
    source = "data:text/javascript;base64," + base64.b64encode(module).decode()
    page = browser.new_page()
    faults: list[str] = []
    page.on("pageerror", lambda error: faults.append(str(error)))
    page.evaluate(DRAW, [source, json.dumps(header), numbers.encoded()])
    canvas = page.locator(".gbeam-canvas")
    first = canvas.screenshot()
    page.locator(".gbeam-time").focus()
    page.keyboard.press("Home")  # it begins at the largest deflection, the end
    page.evaluate("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")
    assert canvas.screenshot() != first
    page.evaluate("window.dispose()")
    page.close()
    assert faults == []

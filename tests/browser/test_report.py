"""The report as a reader sees it, in headless Chromium: pixels, zoom, keys, paper, small windows."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gbeam as gb

F16 = Path(__file__).parents[2] / "examples" / "f16_8g_turn.toml"
CANVAS = ".gbeam-canvas"
TIME = "window.gbeam.viewer.clock.time"

# Whether a plot has ink where the numbers of its two axes stand: beside their titles and ticks.
NUMBERED = """plot => {
  const canvas = plot.querySelector("canvas"), over = plot.querySelector(".u-over"), ratio = devicePixelRatio;
  const copy = new OffscreenCanvas(canvas.width, canvas.height).getContext("2d", {willReadFrequently: true});
  copy.drawImage(canvas, 0, 0);
  const ink = (...box) => copy.getImageData(...box.map(x => x * ratio)).data.some(x => x > 0);
  const [left, top, width, height] = [over.offsetLeft, over.offsetTop, over.offsetWidth, over.offsetHeight];
  return [ink(left - 40, top, 28, height), ink(left, top + height + 11, width, 14)];
}"""


def _seek(page: Any, time: float) -> bytes:
    """Take the clock to a time, and return the picture of the viewer there once it is at rest."""
    page.evaluate(f"window.gbeam.viewer.clock.seek({time})")
    page.evaluate("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")
    picture: bytes = page.locator(CANVAS).screenshot()
    for _ in range(10):  # on a busy machine the page may still be laid out around it
        before, picture = picture, page.locator(CANVAS).screenshot()
        if picture == before:
            break
    return picture


def test_viewer_shows_the_beam_move(opened: Any, report: Path) -> None:
    page = opened(report)
    first, second = _seek(page, 0.0), _seek(page, 0.4)
    assert first != second and _seek(page, 0.0) == first
    page.locator(CANVAS).focus()
    page.keyboard.press("ArrowLeft")
    assert _seek(page, 0.0) != first
    page.keyboard.press("End")
    assert page.evaluate(TIME) == page.evaluate("window.gbeam.viewer.clock.end")
    page.keyboard.press("Home")
    page.evaluate("window.gbeam.viewer.clock.speed = 0.01")  # that it does not end before it is stopped
    page.keyboard.press("Space")
    page.wait_for_function(f"() => {TIME} > window.gbeam.viewer.clock.start")
    page.keyboard.press("Space")
    assert page.get_by_role("button", name="Play").is_visible()
    labels = page.locator(".gbeam-label strong").all_inner_texts()
    assert labels == ["flight, base axes", "spin (centrifuge), base axes", "spin (centrifuge), machine"]


def test_plots_zoom_together_and_lead_the_viewer(opened: Any, report: Path) -> None:
    page = opened(report)
    plots = page.locator(".uplot .u-over")
    assert plots.count() >= 6
    plots.nth(0).scroll_into_view_if_needed()  # the mouse reaches what is in the window
    box = plots.nth(0).bounding_box()
    page.mouse.move(box["x"] + 0.3 * box["width"], box["y"] + 50)
    page.mouse.down()
    page.mouse.move(box["x"] + 0.6 * box["width"], box["y"] + 60, steps=4)
    page.mouse.up()
    page.evaluate("window.gbeam.viewer.clock.seek(window.gbeam.viewer.clock.start)")
    other = plots.nth(1).bounding_box()
    page.mouse.click(other["x"] + 0.5 * other["width"], other["y"] + 40)
    start, end = page.evaluate("[window.gbeam.viewer.clock.start, window.gbeam.viewer.clock.end]")
    # The middle of what both plots show now: 0.3 to 0.6 of the whole.
    assert page.evaluate(TIME) == pytest.approx(start + 0.45 * (end - start), abs=0.02 * (end - start))


@pytest.mark.parametrize("upright", [False, True], ids=["level", "upright"])
def test_two_fingers_bring_the_beam_nearer(opened: Any, report: Path, upright: bool) -> None:
    """As they spread, in whatever direction; one finger across turns the view; the page stays where it is."""
    page = opened(report, width=700, height=740, has_touch=True)
    page.locator(CANVAS).scroll_into_view_if_needed()
    box = page.locator(CANVAS).bounding_box()
    middle = (box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    touches = page.context.new_cdp_session(page)

    def drag(*fingers: Callable[[float], tuple[float, float]]) -> dict[str, float]:
        """Fingers down, along their ways in ten steps, and up; then where the camera and the page are."""
        for kind, share in [("touchStart", 0.0), *(("touchMove", k / 10) for k in range(1, 11)), ("touchEnd", 1.0)]:
            places = [finger(share) for finger in fingers] if kind != "touchEnd" else []
            points = [{"x": middle[0] + x, "y": middle[1] + y, "id": k} for k, (x, y) in enumerate(places)]
            touches.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})
        seen: dict[str, float] = page.evaluate(
            "() => { const o = window.gbeam.viewer.orbit;"
            " return {distance: o.distance, azimuth: o.azimuth, scroll: scrollY, zoom: visualViewport.scale}; }"
        )
        return seen

    def apart(share: float, side: float) -> tuple[float, float]:
        half = side * (30 + 30 * share)
        return (0.0, half) if upright else (half, 0.0)

    still = drag(lambda _: (0.0, 0.0))
    turned = drag(lambda share: (100 * share, 0.0))
    assert turned == still | {"azimuth": pytest.approx(still["azimuth"] - 0.8)}
    pinched = drag(lambda share: apart(share, 1.0), lambda share: apart(share, -1.0))
    assert pinched == turned | {"distance": pytest.approx(0.5 * turned["distance"])}  # twice as far apart


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_small_windows_hold_the_page(opened: Any, report: Path, scheme: str) -> None:
    page = opened(report, width=360, height=740, color_scheme=scheme, has_touch=True)
    assert page.evaluate("document.documentElement.scrollWidth") <= 360
    ground = page.evaluate("getComputedStyle(document.body).backgroundColor")
    assert (max(map(int, re.findall(r"\d+", ground))) < 60) == (scheme == "dark")


def test_the_f16_turn_of_sixteen_seconds_opens_whole(opened: Any, tmp_path: Path) -> None:
    file = tmp_path / "report.html"
    gb.study(gb.read_scenario(F16)).report(file)
    assert file.stat().st_size < 3e6
    page = opened(file, width=360, height=740)
    assert page.evaluate("document.documentElement.scrollWidth") <= 360
    assert page.locator(".uplot").count() >= 12 and page.evaluate("window.gbeam.viewer.clock.end") > 16
    assert _seek(page, 4.9) != _seek(page, 12.0)
    for plot in page.locator(".uplot").all():
        assert all(plot.evaluate(NUMBERED)), plot.get_attribute("aria-label")
    assert "axes are drawn without turning" in page.locator(".gbeam-label").first.inner_text()


def test_axes_turn_where_a_flight_has_rates(opened: Any, tmp_path: Path) -> None:
    beam = gb.Beam(0.3, gb.Section.rectangle(0.02, 0.004), gb.Material(2700, 70e9), damping_ratio=0.01)
    roll = gb.Flight(z=10.0, rates=gb.constant(np.array([2.0, 0.0, 0.0])))
    response = gb.simulate(gb.assemble(beam, "FOAM", y=1, z=1), roll, duration=0.5, name="roll")
    response.report(tmp_path / "report.html")
    page = opened(tmp_path / "report.html")
    assert page.locator(".gbeam-label strong").all_inner_texts() == [
        "roll (flight), base axes",
        "roll (flight), turning",
    ]
    assert "attitude at the start, heading too, not known" in page.locator(".gbeam-label").nth(1).inner_text()
    page.evaluate("window.gbeam.viewer.clock.seek(0.5); window.gbeam.viewer.draw()")
    x, _, _, w = page.evaluate("window.gbeam.viewer.panels[1].carrier.base.quaternion.toArray()")
    assert [w, x] == pytest.approx([math.cos(0.5), math.sin(0.5)], abs=1e-3)  # half of 1 rad


def test_words_are_painted_before_the_views_are_made(opened: Any, report: Path) -> None:
    note = "new MutationObserver(() => { window.drawn ??= performance.now(); })"
    page = opened(report, before=f"{note}.observe(document, {{subtree: true, attributeFilter: ['data-gbeam']}})")
    painted = "performance.getEntriesByName('first-contentful-paint')"
    page.wait_for_function(f"() => {painted}.length")
    assert page.evaluate(f"{painted}[0].startTime") < page.evaluate("window.drawn")


def test_page_without_webgl_says_so(opened: Any, report: Path) -> None:
    none = "HTMLCanvasElement.prototype.getContext = (get => function (kind, ...more) {"
    none += " return kind.startsWith('webgl') ? null : get.call(this, kind, ...more); })"
    none += "(HTMLCanvasElement.prototype.getContext);"
    page = opened(report, before=none)
    assert "shows no WebGL" in page.locator("#gbeam-viewer").inner_text()
    assert page.locator(".uplot").count() >= 6

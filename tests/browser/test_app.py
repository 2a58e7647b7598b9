"""The app as a person uses it, in headless Chromium on the real server."""

from __future__ import annotations

import os
import shlex
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from ..scenarios import FAST, RAMPS
from .axe import violations

BRACKET = Path(__file__).parents[2] / "examples" / "data" / "bracket.msh"
BIG = FAST.replace('"0.5 s"', '"400 s"').replace('title = "fast"', 'title = "long"')


@pytest.fixture
def address(tmp_path: Path) -> Iterator[str]:
    """The address that `gbeam app` prints."""
    pytest.importorskip("fastapi")
    pytest.importorskip("uvicorn")
    command = [sys.executable, "-m", "gbeam", "app", "--folder", str(tmp_path / "kept")]
    server = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=dict(os.environ))
    assert server.stdout is not None
    yield server.stdout.readline().strip()
    server.send_signal(signal.SIGINT)
    server.wait(20)


@pytest.mark.slow
def test_a_person_runs_compares_and_downloads(browser: Any, address: str, tmp_path: Path) -> None:
    home, faults = address.split("/?")[0], list[str]()
    context = browser.new_context(viewport={"width": 1400, "height": 1000}, accept_downloads=True)
    page = context.new_page()
    page.on("console", lambda m: faults.append(m.text) if m.type == "error" else None)
    page.on("pageerror", lambda error: faults.append(str(error)))
    page.on("request", lambda r: faults.append(r.url) if not r.url.startswith((home, "data:", "blob:")) else None)
    page.goto(address)
    page.wait_for_selector("html[data-gbeam]")
    assert page.url == f"{home}/"

    # An example, a wrong value at its field, and the right one; both views show it.
    page.get_by_label("Start from").select_option("Hub")
    page.locator('input[data-path="motion.slew.radius"]').wait_for()
    length = page.locator('input[data-path="beam.length"]')
    length.fill("3 kg")
    length.press("Tab")
    page.wait_for_selector('input[data-path="beam.length"][aria-invalid=true]')
    assert "is a mass" in page.locator(".field .bad", has_text="mass").inner_text()
    assert page.get_by_role("button", name="Run", exact=True).is_disabled()
    # The next field is typed in before the answer about the last has come.
    held: list[Any] = []
    page.route("**/api/edit", lambda route: held.append(route), times=1)
    length.fill("9 m")
    with page.expect_request("**/api/edit"):
        length.press("Tab")
    page.keyboard.type("1 %")
    held[0].continue_()
    page.wait_for_selector("[aria-invalid=true]", state="detached")
    damping = page.locator('input[data-path="beam.damping_ratio"]')
    assert damping.input_value() == "1 %" and damping.evaluate("each => each === document.activeElement")
    page.get_by_role("button", name="Text").click()
    text = page.get_by_label("scenario as TOML")
    page.wait_for_function("() => document.querySelector('textarea').value.includes('damping_ratio = \"1 %\"')")
    assert 'length = "9 m"' in text.input_value()

    # A load is added, with what is missing said where it belongs, and taken away again: the text is what it was.
    before = text.input_value()
    page.get_by_role("button", name="Form").click()
    page.locator('details[data-of="beam"] > summary').click()
    page.get_by_role("button", name="Add loads").click()
    head = page.locator('[data-table="beam.loads[0]"] > .bad')
    head.get_by_text("has neither force nor moment").wait_for()
    page.get_by_role("button", name="Add force").click()
    page.locator('[data-path="beam.loads[0].force.y"]').fill("5 N")
    page.keyboard.press("Tab")
    page.locator(".field .bad", has_text="at is missing").wait_for()
    page.locator('[data-path="beam.loads[0].at"]').fill("8 m")
    page.keyboard.press("Tab")
    page.wait_for_selector("[aria-invalid=true]", state="detached")
    assert 'loads = [{ force = { y = "5 N" }, at = "8 m" }]' in text.input_value()
    assert _violations(page) == []
    page.get_by_label("Remove beam.loads", exact=True).click()
    page.wait_for_function("was => document.querySelector('textarea').value === was", arg=before)
    page.get_by_role("button", name="Text").click()

    # The other way, and a run of it with its report.
    text.fill(FAST)
    page.get_by_role("button", name="Form").click()
    page.wait_for_selector('input[data-path="motion.spin.arm"]')
    _run(page)
    frame = page.frame_locator("iframe.report")
    frame.locator("html[data-gbeam]").wait_for(timeout=20_000)
    assert frame.locator(".gbeam-canvas").is_visible() and "fast" in frame.locator("h1").inner_text()
    # The report is whole: nothing in it is scrolled by itself, so that the views and what plays them are seen together.
    inside = "[document.documentElement.scrollHeight - innerHeight, innerHeight > window.screen.height]"
    page.wait_for_function("() => document.querySelector('iframe.report').style.height")
    assert page.frames[-1].evaluate(inside) == [0, True]
    play = frame.locator(".gbeam-play")
    play.scroll_into_view_if_needed()
    assert play.bounding_box()["y"] + play.bounding_box()["height"] <= 1000
    frame.locator(".gbeam-time").press("Home")
    first = _picture(page)
    frame.locator(".gbeam-time").press("End")
    assert _picture(page) != first
    assert _violations(page) == []
    assert _not_reached(page) == []

    # A sweep, of which a cell opens its run; that one side by side with the first.
    page.get_by_label("Compute").select_option("sweep")
    page.get_by_label("vary").first.select_option("beam.length")
    page.get_by_label("over").first.fill("300 mm, 310 mm")
    assert page.get_by_label("measure").input_value() == ""  # what the verdict is on
    command = page.locator(".verbs code").inner_text()
    words = ["sweep", "scenario.toml", "--over=beam.length=300 mm, 310 mm"]
    assert shlex.split(command) == ["gbeam", *words, "--report"]
    context.grant_permissions(["clipboard-read", "clipboard-write"])
    page.locator(".verbs").get_by_role("button", name="Copy").click()
    page.locator(".verbs").get_by_role("button", name="Copied").wait_for()
    assert page.evaluate("navigator.clipboard.readText()") == command
    page.get_by_role("button", name="Run", exact=True).click()
    page.locator(".gbeam-map button").nth(1).wait_for(timeout=60_000)
    page.locator(".gbeam-wide", has_text="comparisons.spin.verdict.largest_load: a cell opens its run").wait_for()
    assert _violations(page) == []
    page.locator(".gbeam-map button").nth(1).click()
    page.wait_for_function("() => document.querySelectorAll('.run input').length === 2", timeout=60_000)
    for box in page.get_by_role("checkbox", name="compare").all():
        box.check()
    page.get_by_role("heading", name="Compared").wait_for()
    # Of one title: told apart by what has been changed, and to the second.
    assert page.locator(".run", has_text="beam.length = 310 mm").count() == 1
    assert "beam.length = 310 mm" in page.locator(".compared").inner_text()
    row = page.locator("tr", has_text="flight: tip, mm").locator("td").all_inner_texts()
    assert len(row) == 2 and float(row[0]) < float(row[1])
    assert _violations(page) == []

    # Another verb, with an option.
    page.get_by_label("Compute").select_option("static")
    page.get_by_label("at", exact=True).fill("0.2 s")
    page.get_by_role("button", name="Run", exact=True).click()
    page.locator(".run", has_text="static done").wait_for(timeout=60_000)
    page.frame_locator("iframe.report").get_by_text("Displacement of the tip").wait_for(timeout=20_000)
    page.get_by_label("Compute").select_option("run")

    # A long one is cancelled; all are there after a reload, and are downloaded.
    page.get_by_role("button", name="Text").click()
    text.fill(BIG)
    page.wait_for_function("() => document.querySelector('#app pre').textContent.includes('long')")
    page.get_by_role("button", name="Run", exact=True).click()
    page.locator(".run", has_text="long").locator(".faint", has_text=": ").last.wait_for()  # how far it is
    page.get_by_role("button", name="Cancel").click()
    page.locator(".run", has_text="cancelled").wait_for()
    page.get_by_role("button", name="Use this scenario").wait_for()
    assert page.locator("pre.bad").count() == 0  # progress is no complaint
    page.reload()
    page.wait_for_selector("html[data-gbeam]")
    assert page.locator(".run").count() == 5
    page.locator(".run", has_text="compare").last.get_by_role("button").click()
    with page.expect_download() as download:
        page.get_by_role("link", name="result.nc").click()
    assert Path(download.value.path()).read_bytes()[:4] == b"\x89HDF"
    assert page.get_by_label("scenario as TOML").input_value() == BIG  # the draft is kept
    assert faults == []
    # The reports have the figures.
    assert len([*tmp_path.rglob("result.nc")]) == 2 and not [*tmp_path.rglob("*.png")]

    # Without the server the page says so.
    page.route("**/api/**", lambda route: route.abort())
    page.get_by_text("the server does not answer").first.wait_for(timeout=20_000)
    context.close()


@pytest.mark.slow
def test_a_person_maps_a_record_and_opens_what_a_verb_made(browser: Any, address: str, tmp_path: Path) -> None:
    """In a narrow window, with mistakes on the way; none of it is an error of the page."""
    faults = list[str]()
    context = browser.new_context(viewport={"width": 360, "height": 740}, color_scheme="dark", has_touch=True)
    page = context.new_page()
    page.on("console", lambda m: faults.append(m.text) if m.type == "error" else None)
    page.on("pageerror", lambda error: faults.append(str(error)))
    page.goto(address)
    page.wait_for_selector("html[data-gbeam]")

    # A file that is no record, then one whose names, unit of time and sign are its own.
    file = page.get_by_label("Scenario, record or mesh")
    (tmp_path / "no record.csv").write_text("hello\nworld\n")
    file.set_input_files(tmp_path / "no record.csv")
    page.locator(".problems .bad", has_text="rows of numbers").wait_for()
    rows = "".join(f"{10 * i};{-1 - 0.002 * i:.3f}\n" for i in range(101))
    (tmp_path / "pull up 1.csv").write_text(f"Zeit;N_z down\n{rows}")
    page.get_by_label("Start from").select_option("Hub")
    page.locator('input[data-path="motion.slew.radius"]').wait_for()
    file.set_input_files(tmp_path / "pull up 1.csv")
    page.locator(".record .bad", has_text="no flight").wait_for()
    text = page.get_by_label("scenario as TOML")
    page.get_by_role("button", name="Text").click()
    text.fill(FAST.replace(RAMPS, "").replace("6 g", "1.1 g"))
    # Nothing is taken for granted: not the column, not the unit.
    use = page.get_by_role("button", name="Use this record")
    page.locator(".record", has_text="choose a column for x, y or z").wait_for()
    assert use.is_disabled() and page.locator(".suggested select").evaluate_all("all => all.map(x => x.value)") == [
        "Zeit"
    ]
    page.get_by_label("z is").select_option(label="−N_z down")
    page.locator(".record", has_text="choose the unit").wait_for()
    page.locator(".record label", has_text="Unit choose").first.locator("select").select_option("g")
    page.get_by_label("Time in").select_option("ms")
    use.click()
    page.locator("#app .uplot").wait_for()
    written = text.input_value()
    assert 'z = "-N_z down"' in written and 'time_unit = "ms"' in written
    _holds(page)

    # The panel is of the record that the scenario on the page has, with what is written of it.
    title = page.locator(".record h3")
    page.get_by_role("heading", name="Record of flight: pull up 1.csv").wait_for()
    page.get_by_label("Start from").select_option("F-16 turn of 8 g, with its record")
    page.get_by_role("heading", name="Record of flight: f16_8g_turn.csv").wait_for()
    assert page.get_by_label("y is").input_value() == "-n_y_g" and page.locator("#app .uplot").count() == 0
    page.get_by_label("Start from").select_option("Hub")
    title.wait_for(state="detached")
    text.fill(written)
    title.get_by_text("pull up 1.csv").wait_for()
    assert page.get_by_label("z is").input_value() == "-N_z down"
    # Names that say what they are, with their units, are suggested; a sign never is.
    (tmp_path / "b.csv").write_text("t_ms,Acceleration Z [g],p_rad_s,q_rad_s,r_rad_s\n0,1,0,0,0\n10,1,0,0,0\n")
    file.set_input_files(tmp_path / "b.csv")
    title.get_by_text("b.csv, not used yet").wait_for()
    suggested = page.locator(".suggested select").evaluate_all("all => all.map(x => x.value)")
    assert suggested == ["t_ms", "ms", "Acceleration Z [g]", "g", "p_rad_s", "q_rad_s", "r_rad_s", "rad/s"]
    assert page.get_by_label("x is").input_value() == "0" and use.is_enabled()
    # Rates follow the axes of the loads, until one is chosen.
    (tmp_path / "c.csv").write_text("t,n_x,n_y,n_z,p,q,r\n0,0,0,1,0,0,0\n")
    file.set_input_files(tmp_path / "c.csv")
    title.get_by_text("c.csv, not used yet").wait_for()
    for axis in "yz":
        page.get_by_label(f"{axis} is").select_option(f"-n_{axis}")
    assert [page.get_by_label(f"{key} is").input_value() for key in "pqr"] == ["p", "-q", "-r"]
    page.get_by_label("q is").select_option("q")
    page.get_by_label("z is").select_option("n_z")
    assert page.get_by_label("r is").input_value() == "-r"
    _holds(page)
    page.reload()
    page.wait_for_selector("html[data-gbeam]")
    title.get_by_text("pull up 1.csv").wait_for()
    page.get_by_role("button", name="Text").click()

    # A value that is wrong for a verb is said beside it.
    page.get_by_label("Compute").select_option("modes")
    page.get_by_label("motion", exact=False).first.select_option("flight")
    page.locator(".verbs input[placeholder='such as 2 s']").fill("--out")
    page.get_by_role("button", name="Run", exact=True).click()
    page.locator(".verbs > .bad", has_text="nothing that can be read").wait_for()

    # The placed scenario opens as the document; the one that it was made of is there too.
    page.get_by_label("Compute").select_option("place")
    for name in ("no-proof", "write"):
        page.locator(".verbs").get_by_role("checkbox", name=name).check()
    assert page.locator(".verbs code").inner_text() == "gbeam place scenario.toml --no-proof --write --report"
    _holds(page)
    page.get_by_role("button", name="Run", exact=True).click()
    page.get_by_role("button", name="Open placed.toml").click(timeout=60_000)
    page.wait_for_function("was => document.querySelector('textarea').value !== was", arg=written)
    assert 'control_point = "150 mm"' in written and 'control_point = "150 mm"' not in text.input_value()
    page.get_by_role("button", name="Use this scenario").click()
    page.wait_for_function("was => document.querySelector('textarea').value === was", arg=written)
    _holds(page)

    # A run that is refused says why, and a case of a sweep that cannot be run too.
    page.get_by_label("Compute").select_option("sweep")
    page.get_by_label("vary").first.select_option("motion.spin.control_point")
    page.get_by_label("over").first.fill("100 mm, 400 mm")
    page.get_by_label("measure").fill("flight.tip.size.max_abs")
    page.get_by_role("button", name="Run", exact=True).click()
    page.locator(".run", has_text="sweep some cases failed").wait_for(timeout=60_000)
    page.locator("pre.bad", has_text="1 of 2 cases").wait_for()
    page.locator(".gbeam-map button", has_text="–").click()
    page.locator(".gbeam-wide .bad", has_text="beyond the tip").wait_for()
    _holds(page)

    # A sweep of which one case keeps its limits and the other does not says so, in the list and in its map.
    page.get_by_label("over").first.fill("150 mm, 200 mm")
    page.get_by_role("button", name="Text", exact=True).click()
    limited = text.input_value() + '\n[motion.spin.accept]\nlargest_load = "0.37 %"\n'
    text.fill(limited)
    page.wait_for_function("() => sessionStorage.getItem('gbeam-document').includes('largest_load')")
    page.get_by_role("button", name="Run", exact=True).click()
    page.locator(".run", has_text="sweep some cases not accepted").wait_for(timeout=60_000)
    page.locator(".gbeam-wide", has_text="1 done, 1 not accepted").wait_for()
    assert page.locator(".gbeam-map button", has_text="✗").count() == 1
    _holds(page)
    context.close()
    assert faults == []


@pytest.mark.slow
def test_a_person_drops_a_mesh_and_clicks_its_clamp(browser: Any, address: str) -> None:
    pytest.importorskip("meshio")
    faults = list[str]()
    page = browser.new_context(viewport={"width": 1400, "height": 1000}).new_page()
    page.on("console", lambda m: faults.append(m.text) if m.type == "error" else None)
    page.on("pageerror", lambda error: faults.append(str(error)))
    page.goto(address)
    page.wait_for_selector("html[data-gbeam]")
    dropped = page.evaluate_handle(
        """([text, name]) => { const all = new DataTransfer(); all.items.add(new File([text], name)); return all; }""",
        [BRACKET.read_text(encoding="utf-8"), BRACKET.name],
    )
    page.get_by_role("heading", name="Runs").dispatch_event("drop", {"dataTransfer": dropped})
    page.get_by_role("heading", name="Mesh bracket.msh, not used yet").wait_for()
    use, canvas, label = page.get_by_role("button", name="Use this mesh"), page.locator(".skin canvas"), "screwed"
    page.locator(".mesh", has_text="choose the unit").wait_for()
    page.get_by_label("Unit of the coordinates").select_option("mm")
    page.locator(".mesh", has_text="104 × 50 × 85.5 mm").wait_for()
    assert use.is_disabled()
    # From below the face that is screwed down is seen: a click on it, a second one takes it back.
    canvas.focus()
    for _ in range(12):
        page.keyboard.press("ArrowDown")
    box = canvas.bounding_box()
    grids = ((i, j) for step in (4, 1) for j in range(4, 22, step) for i in range(4, 36, step))  # a coarse one first
    places = ((i / 40 * box["width"], j / 24 * box["height"]) for i, j in grids)
    for x, y in places:
        page.mouse.move(box["x"] + x, box["y"] + y)
        if page.locator(".skin .gbeam-label").inner_text() == label:
            break
    ticked = page.get_by_role("checkbox", name="screwed, 93 nodes")
    for on in (True, False, True):
        canvas.click(position={"x": x, "y": y})
        assert ticked.is_checked() is on and use.is_enabled() is on
    assert _violations(page) == []
    use.click()
    page.get_by_role("heading", name="Mesh of bracket: bracket.msh").wait_for()
    page.locator(".field .bad", has_text="damping_ratio is missing").wait_for()
    text = page.get_by_label("scenario as TOML").input_value()
    assert '[bodies.bracket]\nmesh = "bracket.msh"\nunit = "mm"\nclamp = "screwed"\n' in text
    # The list does what a click does.
    page.get_by_role("checkbox", name="camera, 605 nodes").check()
    page.get_by_role("button", name="Change the mesh").click()
    page.wait_for_function("""() => document.querySelector('textarea').value.includes('["screwed", "camera"]')""")
    page.reload()
    page.wait_for_selector("html[data-gbeam]")
    page.get_by_role("checkbox", name="camera, 605 nodes").wait_for()
    assert page.get_by_role("checkbox", name="camera, 605 nodes").is_checked() and faults == []


def _holds(page: Any) -> None:
    """Nothing is wider than the window, and axe finds nothing."""
    assert page.evaluate("document.documentElement.scrollWidth") <= page.viewport_size["width"]
    assert _violations(page) == []


def _picture(page: Any) -> bytes:
    """The viewer of the report that is shown, once it is drawn."""
    report = page.frames[-1]
    report.evaluate("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")
    picture: bytes = report.locator(".gbeam-canvas").screenshot()
    return picture


def _violations(page: Any) -> list[str]:
    """Faults that axe finds in light and in dark."""
    answer = []
    for scheme in ("dark", "light"):
        page.emulate_media(color_scheme=scheme)
        answer += [f"{scheme}: {each}" for each in violations(page)]
    return answer


CONTROLS = """() => [...document.querySelectorAll(
    "button, input, select, textarea, a[href], summary, iframe, [tabindex]"
  )].filter(each => each.checkVisibility() && !each.disabled && each.tabIndex >= 0)"""


def _not_reached(page: Any) -> list[str]:
    """Controls that the Tab key does not come to, from the top of the page."""
    count = page.evaluate(f"() => {{ const all = ({CONTROLS})(); window.left = new Set(all); return all.length; }}")
    page.evaluate("document.body.tabIndex = -1; document.body.focus(); document.body.removeAttribute('tabindex')")
    assert count > 30
    for _ in range(2 * count):
        page.keyboard.press("Tab")
        page.evaluate("window.left.delete(document.activeElement)")
    return list(page.evaluate("[...window.left].map(each => each.outerHTML.slice(0, 200))"))


def _run(page: Any) -> None:
    before = page.locator(".run", has_text="done").count()
    page.get_by_role("button", name="Run", exact=True).click()
    page.wait_for_function(f"() => [...document.querySelectorAll('.run .good')].length > {before}", timeout=60_000)

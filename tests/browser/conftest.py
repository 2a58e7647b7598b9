"""A headless Chromium, and pages in it that record what a page must not do."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from ..calling import main
from ..scenarios import FAST, SLEWING
from .chromium import arguments, environment, find, watch


@pytest.fixture(scope="module")  # while it is open no other test of the process can run an event loop
def browser() -> Iterator[Any]:
    """Chromium; the tests are skipped where there is none."""
    playwright = pytest.importorskip("playwright.sync_api")
    program = find()
    if program is None:
        pytest.skip("no Chromium: `make test` installs one from npm where there is npm, Linux and x86-64")
    with playwright.sync_playwright() as started:
        launched = started.chromium.launch(
            executable_path=str(program), args=arguments(program), env=environment(program)
        )
        yield launched
        launched.close()


SWEEP = ("--over", "beam.length=280 mm:320 mm:3", "--measure", "flight.tip.size.max_abs")
POINTS = ("--over", "motion.spin.control_point=100 mm:200 mm:2")
# Wider than a sheet of paper: columns with long names, and a map.
MANY = (
    *("--over", "motion.spin.control_point=100 mm, 200 mm", "--over", "beam.material.youngs_modulus=69 GPa, 70 GPa"),
    *("--over", "beam.section.thickness=4 mm, 5 mm", "--measure", "flight.tip.size.max_abs, spin.tip.size.max_abs"),
    *("--measure", "spin.loads.root_moment.size.max_abs, spin.loads.root_force.size.max_abs"),
)
WIDE = (
    *("--over", "beam.length=6.1 m:8 m:20", "--over", "motion.slew.radius=0.1 m:0.5 m:2"),
    *("--verb", "critical-speed", "--measure", "critical_speed"),
)
ARM = (Path(__file__).parents[2] / "examples" / "robot_arm.toml").read_text(encoding="utf-8")
# Every kind of report: its scenario and the arguments of its verb.
KINDS: dict[str, tuple[str, tuple[str, ...]]] = {
    "run": (FAST, ()),
    "run of a system": (ARM, ("--set", "response.duration=0.5 s")),
    "static": (FAST, ("--at", "0.2 s")),
    "modes": (FAST, ("--motion", "flight")),
    "campbell": (SLEWING, ("--to", "20 rpm")),
    "critical-speed": (SLEWING, ()),
    "critical-speed of masses": (SLEWING, ("--masses", "0.1 kg, 0.5 kg", "--positions", "2 m, 5 m, 8 m")),
    "plan": (FAST, ()),
    "sensitivity": (FAST, ("--verb", "static", "--motion", "flight", "--at", "0.2 s", "--of", "tip.z")),
    "optimize": (
        FAST,
        ("--verb", "modes", "--motion", "flight", "--minimise", "modes[0].frequency", "--over", "beam.length"),
    ),
    "shape": (SLEWING, ("--angle", "0.2 rad", "--duration", "3 s")),
    "place": (FAST, ()),
    "sweep": (FAST, SWEEP),
    "sweep of two": (FAST, (*SWEEP, *POINTS)),
    "sweep of many": (FAST, MANY),
    "sweep on a wide map": (SLEWING, WIDE),
}


@pytest.fixture(scope="session")
def report_of(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """Make a report of some kind by the command line, once."""

    @cache
    def make(kind: str) -> Path:
        text, arguments = KINDS[kind]
        folder = tmp_path_factory.mktemp("report")
        (folder / "scenario.toml").write_text(text)
        verb = kind.split()[0]
        assert main([verb, str(folder / "scenario.toml"), *arguments, "--out", str(folder), "--report"]) == 0
        (file,) = folder.glob("*.html")
        return file

    return make


@pytest.fixture(scope="session")
def report(report_of: Callable[[str], Path]) -> Path:
    """The report of a run of half a second."""
    return report_of("run")


@pytest.fixture(scope="session", params=KINDS)
def any_report(request: pytest.FixtureRequest, report_of: Callable[[str], Path]) -> Path:
    """A report of each kind."""
    return report_of(request.param)


@pytest.fixture
def opened(browser: Any) -> Iterator[Any]:
    """Open a file in a page of some size and theme; at the end nothing may have been complained of."""
    contexts, every = [], []

    def of(file: Path, width: int = 1200, height: int = 900, before: str = "", **options: Any) -> Any:
        context = browser.new_context(viewport={"width": width, "height": height}, **options)
        contexts.append(context)
        page = context.new_page()
        every.append(watch(page))
        if before:
            page.add_init_script(before)
        page.goto(file.as_uri())
        page.wait_for_selector("html[data-gbeam]")
        return page

    yield of
    for context in contexts:
        context.close()
    assert [faults for faults in every if faults] == []

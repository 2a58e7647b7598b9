"""Notices of what is bundled travel with it."""

from __future__ import annotations

import json
import re
import tomllib
from importlib.resources import files
from pathlib import Path

import gbeam as gb

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
NOTICE = (ROOT / "NOTICE").read_text(encoding="utf-8")
VIEWER, APP = (
    (files(package) / "assets" / name).read_text(encoding="utf-8")
    for package, name in (("gbeam.report.page", "gbeam.js"), ("gbeam.app", "app.js"))
)
GRANT = "Permission is hereby granted, free of charge, to any person obtaining a copy"


def test_every_bundled_package_is_in_the_notice_with_its_version_and_licence() -> None:
    """Known by what web/ imports, the lock of its packages, and names that the built scripts have of each."""
    source = "\n".join(path.read_text(encoding="utf-8") for path in (ROOT / "web" / "src").rglob("*.ts"))
    imported = {name.partition("/")[0] for name in re.findall(r'(?:from|import) "([a-z@][^"]*)"', source)} - {"gbeam"}
    locked = json.loads((ROOT / "web" / "package-lock.json").read_text(encoding="utf-8"))["packages"]
    shipped = {path.removeprefix("node_modules/") for path, each in locked.items() if path and not each.get("dev")}
    assert imported == shipped
    parts = re.split(r"^(\S+ \d+\.\d+\.\d+)\n", NOTICE, flags=re.MULTILINE)
    assert set(parts[1::2]) == {f"{name} {locked[f'node_modules/{name}']['version']}" for name in shipped}
    for name, text in zip(parts[1::2], parts[2::2], strict=True):
        assert GRANT in text and re.search(r"^Copyright .*\d{4}", text, re.MULTILINE), name
    built = {"three": VIEWER, "uplot": VIEWER + APP}
    assert built.keys() == shipped and f"`{locked['node_modules/three']['version'].split('.')[1]}`" in built["three"]
    assert "uplot" in APP and "WebGLRenderer" not in APP


def test_the_notice_is_at_the_head_of_every_script_and_in_the_wheel() -> None:
    assert VIEWER.startswith(f"/*!\n{NOTICE}*/\n")
    uplot = NOTICE[NOTICE.index("uplot 1") :]
    assert APP.startswith("/*!\n") and APP.partition("*/")[0].endswith(uplot)
    assert PROJECT["license-files"] == ["LICENSE", "NOTICE"]


def test_a_report_carries_the_notice(tmp_path: Path) -> None:
    beam = gb.Beam(0.3, gb.Section.rectangle(0.02, 0.004), gb.Material(2700, 70e9), damping_ratio=0.01)
    gb.modes(gb.assemble(beam, "FOAM", y=1, z=1)).report(tmp_path / "r.html")
    assert NOTICE in (tmp_path / "r.html").read_text(encoding="utf-8")

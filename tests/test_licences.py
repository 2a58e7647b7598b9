"""Notices of what is bundled travel with it, and what gbeam needs is free software."""

from __future__ import annotations

import json
import re
import tomllib
from importlib.metadata import PackageNotFoundError, distribution
from importlib.resources import files
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

import gbeam as gb

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
NOTICE = (ROOT / "NOTICE").read_text(encoding="utf-8")
VIEWER, APP = (
    (files(package) / "assets" / name).read_text(encoding="utf-8")
    for package, name in (("gbeam.report.page", "gbeam.js"), ("gbeam.app", "app.js"))
)
GRANT = "Permission is hereby granted, free of charge, to any person obtaining a copy"
# Licences of free software, as metadata name them: SPDX, trove classifiers, and older words.
FREE = {
    "0BSD", "Apache-2.0", "Apache Software License", "BSD", "BSD 2-Clause License", "BSD-2-Clause", "BSD-3-Clause",
    "BSD License", "CC0-1.0", "GPL-3.0-or-later WITH GCC-exception-3.1", "MIT", "MIT-CMU", "MIT License", "PSF-2.0",
    "Python Software Foundation License", "Zlib",
}  # fmt: skip
# Locked for other platforms or Pythons, so that their metadata are not always here.
ELSEWHERE = {"colorama": "BSD-3-Clause", "importlib-metadata": "Apache-2.0", "msgspec": "BSD-3-Clause", "zipp": "MIT"}


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


def needed(requirements: list[str]) -> set[str]:
    """Names of all packages that pip brings here for some requirements."""
    ahead, seen = [(Requirement(each), "") for each in requirements], set[tuple[str, str]]()
    while ahead:
        requirement, extra = ahead.pop()
        if requirement.marker and not requirement.marker.evaluate({"extra": extra}):
            continue
        name = canonicalize_name(requirement.name)
        further = {(name, each) for each in {"", *requirement.extras}} - seen
        seen |= further
        ahead += [(Requirement(line), each) for _, each in further for line in distribution(name).requires or ()]
    return {name for name, _ in seen}


def licences(name: str) -> set[str]:
    """Licences of an installed package: its SPDX expression, else its classifiers, else the first line of its text."""
    metadata = distribution(name).metadata
    classifiers = [each for each in metadata.get_all("Classifier", []) if each.startswith("License ::")]
    if expression := metadata.get("License-Expression"):
        return set(re.split(r" AND | OR ", expression.replace("(", "").replace(")", "")))
    if classifiers:
        return {each.rpartition(" :: ")[2] for each in classifiers}
    return {metadata.get("License", "none").partition("\n")[0]}


def test_gbeam_and_its_meshes_bring_free_software_only() -> None:
    packages = needed([*PROJECT["dependencies"], *PROJECT["optional-dependencies"]["mesh"]])
    locked = (ROOT / "requirements.lock").read_text(encoding="utf-8")
    packages |= {canonicalize_name(each) for each in re.findall(r"^([\w.-]+)==", locked, re.MULTILINE)}
    assert packages > {"numpy", "scipy", "jax", "meshio", "scikit-fem", "rslab"}
    known: dict[str, set[str]] = {}
    for name in packages:
        try:
            known[name] = licences(name)
        except PackageNotFoundError:
            known[name] = {ELSEWHERE.get(name, "not installed")}
    assert {name: each for name, each in known.items() if not each <= FREE} == {}


@pytest.mark.parametrize(
    ("lines", "free"),
    [
        ("License: Intel Simplified Software License\nClassifier: License :: Other/Proprietary License", False),
        ("License-Expression: LicenseRef-Proprietary", False),
        ("License: MIT", True),
        ("License-Expression: (MIT OR Apache-2.0) AND BSD-3-Clause", True),
        ("License-Expression: MIT AND LicenseRef-Proprietary", False),
        ("Summary: of no licence at all", False),
    ],
)
def test_metadata_tell_what_is_free(lines: str, free: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "some-1.dist-info").mkdir()
    metadata = f"Metadata-Version: 2.4\nName: some\nVersion: 1\n{lines}\n"
    (tmp_path / "some-1.dist-info" / "METADATA").write_text(metadata, encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    assert (licences("some") <= FREE) == free


def test_what_is_not_free_is_in_an_extra_that_says_so() -> None:
    """MKL is no dependency of anything but the extra `pardiso`, and neither lock has it."""
    extras = PROJECT["optional-dependencies"]
    assert [name for name, lines in extras.items() if any("pardiso" in line for line in lines)] == ["pardiso"]
    for name in ("requirements.lock", "requirements-dev.lock"):
        assert not re.search(
            r"^(pypardiso|mkl|intel-openmp)==", (ROOT / name).read_text(encoding="utf-8"), re.MULTILINE
        )
    for place in (ROOT / "pyproject.toml", ROOT / "docs" / "howto" / "solid.md"):
        assert "Intel Simplified Software License" in " ".join(place.read_text(encoding="utf-8").split())

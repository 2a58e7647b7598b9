"""The routes with whatever their schema allows: no answer is a defect."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from ..scenarios import FAST
from .conftest import Site


def test_no_request_is_a_defect(tmp_path: Path) -> None:
    pytest.importorskip("fastapi")
    schemathesis: Any = pytest.importorskip("schemathesis")  # here: every process of the tests imports the files
    hypothesis: Any = pytest.importorskip("hypothesis")
    from gbeam.app import create_app

    schema = schemathesis.openapi.from_asgi("/openapi.json", create_app(tmp_path))
    tried = 0
    for operation in schema.get_all_operations():
        built = operation.ok()

        @hypothesis.settings(max_examples=12)
        @hypothesis.given(case=built.as_strategy())
        def answered(case: Any) -> None:
            nonlocal tried
            tried += 1
            assert case.call().status_code < 500

        answered()
    assert tried > 60


def test_half_a_character_is_refused(site: Site) -> None:
    half = "\ud800"
    headers = {**site.opened, "content-type": "application/json"}
    for path, body in (
        ("document", {"text": half}),
        ("document", {"text": 3, "x": half}),
        ("document", {"text": '{"title": "\\ud800"}'}),
        ("edit", {"text": 'title = "a"', "path": "title", "value": half}),
        ("add", {"text": FAST, "path": "beam", "choice": half}),
        ("record", {"text": FAST, "motion": "flight", "record": {"file": half}}),
        ("runs", {"text": FAST, "verb": half}),
        ("runs", {"text": FAST, "verb": "modes", "options": [f"motion={half}"]}),
        ("runs", {"text": FAST, "case": half}),
    ):
        answer = site.call("POST", f"/api/{path}", headers, content=json.dumps(body))
        assert answer.status_code == 422 or answer.json()["errors"], body
    assert site.call("GET", "/api/runs", site.opened).json() == []


def test_a_body_that_is_nested_deeply_is_refused(site: Site) -> None:
    for body in ("[" * 100_000, '{"text":' + "[" * 900 + "]" * 900 + "}"):
        headers = {**site.opened, "content-type": "application/json"}
        assert site.call("POST", "/api/document", headers, content=body).status_code in (400, 422)
    answer = site.call("POST", "/api/document", site.opened, json={"text": '{"a":' * 900 + "1" + "}" * 900})
    assert answer.json()["errors"]

"""The routes with whatever their schema allows: no answer is a defect."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest


def test_no_request_is_a_defect(tmp_path: Path) -> None:
    pytest.importorskip("fastapi")
    schemathesis: Any = pytest.importorskip("schemathesis")  # here: every process of the tests imports the files
    hypothesis: Any = pytest.importorskip("hypothesis")
    from gbeam.app.server import create_app

    schema = schemathesis.openapi.from_asgi("/openapi.json", create_app(tmp_path))
    tried = 0
    for operation in schema.get_all_operations():
        made = operation.ok()

        @hypothesis.settings(max_examples=12, deadline=None, derandomize=True, database=None)
        @hypothesis.given(case=made.as_strategy())
        def answered(case: Any) -> None:
            nonlocal tried
            tried += 1
            assert case.call().status_code < 500

        answered()
    assert tried > 60

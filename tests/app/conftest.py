"""The app, called without a network."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from ..calling import gbeam

__all__ = ["gbeam"]

PORT = 4321
HOST = f"http://127.0.0.1:{PORT}"


@dataclass
class Site:
    """The app behind its door, and what calls it; `opened` has the session's cookie and key, `reader` opens files."""

    folder: Path
    call: Callable[..., Any]
    opened: dict[str, str]
    reader: str


@pytest.fixture
def site(tmp_path: Path) -> Site:
    """The app over an empty folder."""
    pytest.importorskip("fastapi")
    httpx = pytest.importorskip("httpx")
    import asyncio

    from gbeam.app import Door, create_app

    door = Door(create_app(tmp_path), PORT, "the-token")

    def call(method: str, path: str, headers: dict[str, str] | None = None, **more: Any) -> Any:
        async def once() -> Any:
            transport = httpx.ASGITransport(app=door, raise_app_exceptions=False)
            async with httpx.AsyncClient(transport=transport, base_url=HOST) as client:
                return await client.request(method, path, headers=headers, **more)

        return asyncio.run(once())

    answer = call("GET", "/?token=the-token")
    cookie = answer.headers["set-cookie"].split(";")[0]
    key, reader = answer.headers["location"].removeprefix("/#").split(".")
    return Site(tmp_path, call, {"cookie": cookie, "origin": HOST, "x-gbeam-key": key}, reader)

"""Who may talk to the server: this computer's browser, on the page that the server itself gave it.

A browser sends a cookie to every port of a computer, even to a server of another user. Therefore the cookie opens only
the page, which holds no secret. All other requests also need a key, which comes in the fragment of an address, which is
never sent, and which the browser stores for this port only: the page's script sends it in a header. In the addresses of
files, which the browser itself fetches, it sends another key, which opens only files.
"""

from __future__ import annotations

import asyncio
import secrets
import socket
import sys
from functools import cached_property
from typing import Any
from urllib.parse import parse_qs

from fastapi import HTTPException

KEY = "x-gbeam-key"  # header
ASSETS = {"app.css": "gbeam.app", "app.js": "gbeam.app", "gbeam.js": "gbeam.report.page"}  # names and packages
_PAGE = ("/", *(f"/{name}" for name in ASSETS))
_FILES = "/api/runs/"
# Nothing inline, nothing from elsewhere; reports are shown in a frame with a policy of their own.
POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; connect-src 'self'; "
    "frame-src 'self'; frame-ancestors 'none'; base-uri 'none'; form-action 'none'"
)
# A report comes from data: it may run its own script, in an origin of its own, without the session.
REPORT_POLICY = "sandbox allow-scripts; frame-ancestors 'self'"
_SAFE = ("GET", "HEAD")
UNKNOWN = "open the address that `gbeam app` printed"
LARGEST = 80 * 2**20  # bytes of a request: a record of 64 MiB, and more


class Door:
    """Refuses foreign hosts and origins, requests without the session's cookie or `token`, and too large ones."""

    def __init__(self, app: Any, port: int, token: str) -> None:
        self._app = app
        self._hosts = {f"{name}:{port}" for name in ("127.0.0.1", "localhost")}
        self._cookie = f"gbeam-session-{port}"  # with the port, so that it replaces no other server's
        self._token = token
        self._session, self._key, self._reader = (secrets.token_urlsafe(32) for _ in range(3))

    async def __call__(self, scope: Any, receive: Any, send: Any) -> None:
        """Let a request pass, or answer it."""
        if scope["type"] == "lifespan":
            await self._app(scope, receive, send)
            return
        if scope["type"] != "http":
            return  # no other protocol is supported
        headers = {name.decode("latin-1"): value.decode("latin-1") for name, value in scope["headers"]}
        refusal = self._refusal(scope, headers)
        if refusal is not None:
            await _answer(send, *refusal)
            return

        async def protected(message: Any) -> None:
            if message["type"] == "http.response.start":
                present = {name.lower() for name, _ in message["headers"]}
                message["headers"] = [*message["headers"], *((k, v) for k, v in _HEADERS if k not in present)]
            await send(message)

        await self._app(scope, _limited(receive), protected)

    def _refusal(self, scope: Any, headers: dict[str, str]) -> tuple[int, str, list[tuple[bytes, bytes]]] | None:
        """Status, text and headers of the answer that refuses a request, or lets a browser in,
        or None if it may pass.
        """
        if headers.get("host") not in self._hosts:
            return 403, "foreign host", []
        origins = {f"http://{host}" for host in self._hosts}
        origin = headers.get("origin")
        if origin is not None and origin not in origins:
            return 403, "foreign origin", []
        if headers.get("sec-fetch-site", "same-origin") not in ("same-origin", "none"):
            return 403, "foreign page", []
        if scope["method"] not in _SAFE and origin is None:
            return 403, "no origin", []
        if int(headers.get("content-length") or 0) > LARGEST:
            return 413, "too large", []
        query = parse_qs(scope["query_string"].decode("latin-1"))
        if scope["path"] == "/" and scope["method"] == "GET" and _match(query.get("token", [""])[0], self._token):
            cookie = f"{self._cookie}={self._session}; HttpOnly; SameSite=Strict; Path=/"
            # To the same place without the token, which is then in no history; the page removes the keys from there.
            place = f"/#{self._key}.{self._reader}"
            return 303, "", [(b"location", place.encode()), (b"set-cookie", cookie.encode())]
        pairs = (entry.strip().partition("=") for entry in headers.get("cookie", "").split(";"))
        session = next((value for name, _, value in pairs if name == self._cookie), "")
        if not _match(session, self._session):
            return 401, UNKNOWN, []
        reads = scope["method"] in _SAFE and scope["path"].startswith(_FILES)
        authorised = scope["path"] in _PAGE or _match(headers.get(KEY, ""), self._key)
        if not authorised and not (reads and _match(query.get("key", [""])[0], self._reader)):
            return 401, UNKNOWN, []
        return None


def _match(answer: str, secret: str) -> bool:
    return secrets.compare_digest(answer.encode(), secret.encode())


_HEADERS = [
    (b"content-security-policy", POLICY.encode()),
    (b"x-content-type-options", b"nosniff"),
    (b"referrer-policy", b"no-referrer"),
    (b"cross-origin-resource-policy", b"same-origin"),
    (b"cache-control", b"no-store"),
]


def _limited(receive: Any) -> Any:
    """Return a `receive` that refuses a body beyond the largest size, whatever length its headers state."""
    size = 0

    async def limited() -> Any:
        nonlocal size
        message = await receive()
        size += len(message.get("body", b""))
        if size > LARGEST:
            raise HTTPException(413, "too large")  # readers of a body pass it on
        return message

    return limited


async def _answer(send: Any, status: int, text: str, headers: list[tuple[bytes, bytes]]) -> None:
    plain = [(b"content-type", b"text/plain; charset=utf-8"), *_HEADERS]
    await send({"type": "http.response.start", "status": status, "headers": [*plain, *headers]})
    await send({"type": "http.response.body", "body": text.encode()})


PATIENCE = 10.0  # s without a request
MOST = 64  # connections, and no more than a quarter of the descriptors; a browser opens six
AT_ONCE = 8  # connections that are accepted before the first of them can be closed
_WAITING = 1024  # connections that wait in the system to be accepted


class Listening(socket.socket):
    """Socket with a long queue: asyncio would accept as many connections at once as it lets wait."""

    def listen(self, backlog: int = _WAITING, /) -> None:
        """Listen with a queue of at least 1024 connections."""
        super().listen(max(backlog, _WAITING))


def listening(port: int) -> Listening:
    """Return a socket that listens on a port of 127.0.0.1, 0 for any that is free."""
    return Listening(fileno=socket.create_server(("127.0.0.1", port)).detach())


class Connections:
    """Closes connections of an ASGI app that are idle for long, and the longest idle one if there are too many."""

    def __init__(self, app: Any) -> None:
        self._app, self._most = app, min(MOST, _descriptors() // 4)
        self._open: dict[Any, asyncio.Transport] = {}  # by the address of the other end
        self._idle: dict[Any, asyncio.TimerHandle] = {}  # likewise, the longest idle first

    async def __call__(self, scope: Any, receive: Any, send: Any) -> None:
        """Answer a request; its connection is not idle until then."""
        peer = tuple(scope.get("client") or ())
        self._busy(peer)
        try:
            await self._app(scope, receive, send)
        finally:
            if peer in self._open:
                self._wait(peer)

    @cached_property
    def protocol(self) -> type[asyncio.Protocol]:
        """Class of uvicorn's HTTP protocol that reports its connections."""
        from uvicorn.protocols.http.auto import AutoHTTPProtocol

        connections = self

        class Watched(AutoHTTPProtocol):  # type: ignore[misc, valid-type]  # one of two classes, chosen as it is imported
            """HTTP protocol of one connection."""

            def connection_made(self, transport: Any) -> None:
                self.peer = transport.get_extra_info("peername") or transport
                connections.add(self.peer, transport)
                super().connection_made(transport)

            def connection_lost(self, error: Exception | None) -> None:
                connections.remove(self.peer)
                super().connection_lost(error)

        return Watched

    def add(self, peer: Any, transport: asyncio.Transport) -> None:
        """Count a new connection; with too many, close the longest idle one, or the new one if none is idle."""
        if len(self._open) >= self._most:
            if not self._idle:
                transport.abort()
                return
            self._close(next(iter(self._idle)))
        self._open[peer] = transport
        self._wait(peer)

    def remove(self, peer: Any) -> None:
        """Forget a connection."""
        self._busy(peer)
        self._open.pop(peer, None)

    def _wait(self, peer: Any) -> None:
        self._idle[peer] = asyncio.get_running_loop().call_later(PATIENCE, self._close, peer)

    def _busy(self, peer: Any) -> None:
        timer = self._idle.pop(peer, None)
        if timer is not None:
            timer.cancel()

    def _close(self, peer: Any) -> None:
        transport = self._open[peer]
        self.remove(peer)
        transport.abort()


def _descriptors() -> int:
    """Number of file descriptors that the process may open."""
    if sys.platform == "win32":
        return 4 * MOST
    import resource

    limit: int = resource.getrlimit(resource.RLIMIT_NOFILE)[0]
    return 4 * MOST if limit == resource.RLIM_INFINITY else limit

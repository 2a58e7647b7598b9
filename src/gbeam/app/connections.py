"""Connections of the server: at most so many, none idle for long, so that no stranger uses up the descriptors."""

from __future__ import annotations

import asyncio
import socket
import sys
from typing import Any

PATIENCE = 10.0  # s without a request
MOST = 64  # connections, and no more than a quarter of the descriptors; a browser opens six
AT_ONCE = 8  # connections that are taken before the first of them can be closed
_WAITING = 1024  # that wait to be taken, in the system's memory


class Listening(socket.socket):
    """A socket on this computer alone: asyncio takes as many connections at once as it lets wait, here fewer."""

    def listen(self, backlog: int = _WAITING, /) -> None:
        """Let many wait, whatever asyncio says."""
        super().listen(max(backlog, _WAITING))


def listening(port: int) -> Listening:
    """Return a socket that listens on a port of 127.0.0.1, 0 for any that is free."""
    return Listening(fileno=socket.create_server(("127.0.0.1", port)).detach())


class Connections:
    """Closes connections that ask for nothing; where there are too many, the one that has been idle longest.

    Parameters
    ----------
    app : ASGI application
    """

    def __init__(self, app: Any) -> None:
        self._app, self._most = app, min(MOST, _descriptors() // 4)
        self._open: dict[Any, asyncio.Transport] = {}  # by the other end
        self._idle: dict[Any, asyncio.TimerHandle] = {}  # the longest idle first

    async def __call__(self, scope: Any, receive: Any, send: Any) -> None:
        """Answer a request, whose connection is not idle meanwhile."""
        other = tuple(scope.get("client") or ())
        self._busy(other)
        try:
            await self._app(scope, receive, send)
        finally:
            if other in self._open:
                self._wait(other)

    def protocol(self, **given: Any) -> asyncio.Protocol:
        """Return what speaks HTTP on a new connection, as uvicorn asks for it."""
        from uvicorn.protocols.http.auto import AutoHTTPProtocol

        return _Watched(AutoHTTPProtocol(**given), self)

    def opened(self, other: Any, transport: asyncio.Transport) -> None:
        """Keep a new connection, in place of the longest idle one where there are too many."""
        if len(self._open) >= self._most:
            if not self._idle:
                transport.abort()
                return
            self._close(next(iter(self._idle)))
        self._open[other] = transport
        self._wait(other)

    def closed(self, other: Any) -> None:
        """Forget a connection."""
        self._busy(other)
        self._open.pop(other, None)

    def _wait(self, other: Any) -> None:
        self._idle[other] = asyncio.get_running_loop().call_later(PATIENCE, self._close, other)

    def _busy(self, other: Any) -> None:
        timer = self._idle.pop(other, None)
        if timer is not None:
            timer.cancel()

    def _close(self, other: Any) -> None:
        transport = self._open[other]
        self.closed(other)
        transport.abort()


def _descriptors() -> int:
    """How many descriptors the process may have."""
    if sys.platform == "win32":
        return 4 * MOST
    import resource

    limit: int = resource.getrlimit(resource.RLIMIT_NOFILE)[0]
    return 4 * MOST if limit == resource.RLIM_INFINITY else limit


class _Watched(asyncio.Protocol):
    """A protocol whose connection is counted."""

    def __init__(self, inner: asyncio.Protocol, connections: Connections) -> None:
        self._inner, self._connections = inner, connections
        self._other: Any = None

    def connection_made(self, transport: Any) -> None:
        self._other = transport.get_extra_info("peername") or transport
        self._connections.opened(self._other, transport)
        self._inner.connection_made(transport)

    def connection_lost(self, error: Exception | None) -> None:
        self._connections.closed(self._other)
        self._inner.connection_lost(error)

    def data_received(self, data: bytes) -> None:
        self._inner.data_received(data)

    def eof_received(self) -> bool | None:
        return self._inner.eof_received()

    def pause_writing(self) -> None:
        self._inner.pause_writing()

    def resume_writing(self) -> None:
        self._inner.resume_writing()

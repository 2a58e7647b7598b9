"""Who may talk to the server: this computer's browser, on the page that the server itself gave it."""

from __future__ import annotations

import secrets
from typing import Any
from urllib.parse import parse_qs

COOKIE = "gbeam-session"
# Nothing inline, nothing from elsewhere; reports are shown in a frame with a policy of their own.
POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; connect-src 'self'; "
    "frame-src 'self'; frame-ancestors 'none'; base-uri 'none'; form-action 'none'"
)
# A report comes from data: it may run its own script, in an origin of its own, without the session.
REPORT_POLICY = "sandbox allow-scripts; frame-ancestors 'self'"
_SAFE = ("GET", "HEAD")
LARGEST = 80 * 2**20  # bytes of a request: a record of 64 MiB, and what is around it


class Door:
    """Refuses foreign hosts and origins, requests without the session, and what is too large.

    Parameters
    ----------
    app : ASGI application
    port : int
        That the server listens on.
    token : str
        In the address that is printed: whoever opens that gets the session's cookie.
    """

    def __init__(self, app: Any, port: int, token: str) -> None:
        self._app = app
        self._hosts = {f"{name}:{port}" for name in ("127.0.0.1", "localhost")}
        self._token, self._session = token, secrets.token_urlsafe(32)

    async def __call__(self, scope: Any, receive: Any, send: Any) -> None:
        """Let a request pass, or answer it."""
        if scope["type"] == "lifespan":
            await self._app(scope, receive, send)
            return
        if scope["type"] != "http":
            return  # no other protocol is spoken
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
        if headers.get("host") not in self._hosts:
            return 403, "foreign host", []
        own = {f"http://{host}" for host in self._hosts}
        origin = headers.get("origin")
        if origin is not None and origin not in own:
            return 403, "foreign origin", []
        if headers.get("sec-fetch-site", "same-origin") not in ("same-origin", "none"):
            return 403, "foreign page", []
        if scope["method"] not in _SAFE and origin is None:
            return 403, "no origin", []
        if int(headers.get("content-length") or 0) > LARGEST:
            return 413, "too large", []
        if scope["path"] == "/" and scope["method"] == "GET":
            given = parse_qs(scope["query_string"].decode("latin-1")).get("token", [""])[0]
            if given and secrets.compare_digest(given.encode(), self._token.encode()):
                cookie = f"{COOKIE}={self._session}; HttpOnly; SameSite=Strict; Path=/"
                # To the same place without the token, which is then in no history.
                return 303, "", [(b"location", b"/"), (b"set-cookie", cookie.encode())]
        pairs = (each.strip().partition("=") for each in headers.get("cookie", "").split(";"))
        session = next((value for name, _, value in pairs if name == COOKIE), "")
        if not secrets.compare_digest(session.encode(), self._session.encode()):
            return 401, "open the address that `gbeam app` printed", []
        return None


_HEADERS = [
    (b"content-security-policy", POLICY.encode()),
    (b"x-content-type-options", b"nosniff"),
    (b"referrer-policy", b"no-referrer"),
    (b"cross-origin-resource-policy", b"same-origin"),
    (b"cache-control", b"no-store"),
]


def _limited(receive: Any) -> Any:
    """The body of a request, up to the largest size, whatever its head says."""
    size = 0

    async def limited() -> Any:
        nonlocal size
        message = await receive()
        size += len(message.get("body", b""))
        if size > LARGEST:
            return {"type": "http.disconnect"}
        return message

    return limited


async def _answer(send: Any, status: int, text: str, headers: list[tuple[bytes, bytes]]) -> None:
    plain = [(b"content-type", b"text/plain; charset=utf-8"), *_HEADERS]
    await send({"type": "http.response.start", "status": status, "headers": [*plain, *headers]})
    await send({"type": "http.response.body", "body": text.encode()})

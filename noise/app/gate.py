"""Access control of the app: it refuses requests without token, to other hosts or from other sites.

Any page that a browser shows may send requests to the loopback address, and a name on the network
may be made to point there (DNS rebinding). So a request needs the token that only the printed
address has, or the cookie that this address sets; its Host is the loopback address itself; and what
changes something comes from the app's own pages. Each of these tells the token of its address: the
cookie may be that of a program which came after it at the same port. Bodies are JSON objects of a
size that a page of ours sends.
"""

from __future__ import annotations

import hmac
import json
from collections.abc import Awaitable, Callable
from typing import TYPE_CHECKING, Any
from urllib.parse import parse_qs

from starlette.concurrency import run_in_threadpool
from starlette.datastructures import Headers, MutableHeaders
from starlette.responses import PlainTextResponse

from models.errors import ParameterError

if TYPE_CHECKING:
    from starlette.requests import Request
    from starlette.responses import Response
    from starlette.types import ASGIApp, Message, Receive, Scope, Send


_POLICY = (
    "default-src 'none'; script-src 'self'; connect-src 'self'; img-src 'self' data: blob:; "
    "media-src 'self' blob:; style-src 'self' 'unsafe-inline'; worker-src 'self'; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
_HEADERS = {
    "Content-Security-Policy": _POLICY,
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",  # or the token in the address would go along
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cache-Control": "no-store",
}


class Gate:
    """Middleware that accepts requests from the printed address only.

    Parameters
    ----------
    app : ASGI application
        What stands behind it.
    token : str
        That the printed address has.
    port : int
        Of the server [-].
    """

    def __init__(self, app: ASGIApp, token: str, port: int) -> None:
        self._app = app
        self._token = token
        self._cookie = f"bushing-noise-{port}"  # cookies do not tell ports apart
        self._hosts = {f"127.0.0.1:{port}", f"localhost:{port}"}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer or refuse a request."""
        if scope["type"] == "lifespan":
            await self._app(scope, receive, send)
            return
        reason = self._refusal(scope)
        if scope["type"] != "http":
            reason = reason or "there are no sockets here"

        async def guarded(message: Message) -> None:
            if message["type"] == "http.response.start":
                headers = MutableHeaders(scope=message)
                for name, value in _HEADERS.items():
                    headers[name] = value
                if reason is None:
                    headers.append(
                        "Set-Cookie",
                        f"{self._cookie}={self._token}; HttpOnly; SameSite=Strict; Path=/",
                    )
            await send(message)

        if reason is not None:
            if scope["type"] == "http":
                await PlainTextResponse(f"refused: {reason}\n", 403)(scope, receive, guarded)
            return
        await self._app(scope, receive, guarded)

    def _refusal(self, scope: Scope) -> str | None:
        headers = Headers(scope=scope)
        if headers.get("host") not in self._hosts:
            return "wrong host"
        origin = headers.get("origin")
        if origin is not None and origin not in {f"http://{host}" for host in self._hosts}:
            return "wrong origin"
        if origin is None and headers.get("sec-fetch-site", "none") not in {"same-origin", "none"}:
            return "wrong origin"
        # Of several, each has to be right: none is passed on to be read in another way.
        given = parse_qs(scope["query_string"].decode("latin-1")).get("token", [])
        given += headers.getlist("page-token")
        if not given:
            # Other programs on this machine set cookies here as well, of whatever form.
            pairs = (one.strip().partition("=") for one in headers.get("cookie", "").split(";"))
            given = [value for name, _, value in pairs if name == self._cookie]
        right = [hmac.compare_digest(one.encode(), self._token.encode()) for one in given]
        return None if right and all(right) else "wrong token"


_MOST = 4 << 20
"""Longest body [byte]."""


def body(
    answer: Callable[[Request, dict[str, Any]], Response],
) -> Callable[[Request], Awaitable[Response]]:
    """Return an endpoint that passes on a request and its JSON object.

    Parameters
    ----------
    answer : callable
        From request and body to response; it runs in a thread, so it may take its time.

    Raises
    ------
    ParameterError
        The body is too long or no JSON object.
    """

    async def endpoint(request: Request) -> Response:
        read = bytearray()
        async for piece in request.stream():
            read += piece
            if len(read) > _MOST:
                raise ParameterError(f"the request is longer than {_MOST} bytes")
        try:
            content = json.loads(bytes(read) or b"{}")
        except (ValueError, RecursionError):
            content = None
        if not isinstance(content, dict):
            raise ParameterError("the request is no JSON object")
        return await run_in_threadpool(answer, request, content)

    return endpoint

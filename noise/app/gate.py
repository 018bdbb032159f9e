"""The app's door: a request without the token, for another host or from another site gets nothing.

Any page that a browser shows may send requests to the loopback address, and a name on the network
may be made to point there (DNS rebinding). So a request needs the token that only the printed
address has, or the cookie that this address sets; its Host is the loopback address itself; and what
changes something comes from the app's own pages. Each of these tells the token of its address: the
cookie may be that of a program which came after it at the same port.
"""

from __future__ import annotations

import hmac
from typing import TYPE_CHECKING
from urllib.parse import parse_qs

from starlette.datastructures import Headers, MutableHeaders
from starlette.responses import PlainTextResponse

if TYPE_CHECKING:
    from starlette.types import ASGIApp, Message, Receive, Scope, Send

__all__ = ["Gate"]

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
    """Let through what comes from the printed address alone.

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
        """Answer a request, or refuse it."""
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
        said = parse_qs(scope["query_string"].decode("latin-1")).get("token", [])
        said += headers.getlist("page-token")
        if not said:
            # Other programs on this machine set cookies here as well, of whatever form.
            pairs = (one.strip().partition("=") for one in headers.get("cookie", "").split(";"))
            said = [value for name, _, value in pairs if name == self._cookie]
        right = [hmac.compare_digest(one.encode(), self._token.encode()) for one in said]
        return None if right and all(right) else "wrong token"

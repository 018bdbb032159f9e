"""Routes that are made once the first request for one of them comes."""

from __future__ import annotations

from threading import Lock
from typing import TYPE_CHECKING

from starlette.concurrency import run_in_threadpool
from starlette.routing import BaseRoute, Match, Router

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from starlette.types import Receive, Scope, Send

__all__ = ["LazyRoutes"]


class LazyRoutes(BaseRoute):
    """All routes that begin alike.

    Parameters
    ----------
    prefix : str
        That they begin with.
    make : callable
        Returns them; called once, in a thread, since it may take its time.
    """

    def __init__(self, prefix: str, make: Callable[[], Sequence[BaseRoute]]) -> None:
        self._prefix, self._make = prefix, make
        self._lock = Lock()
        self._router: Router | None = None

    def matches(self, scope: Scope) -> tuple[Match, Scope]:
        """Whether a request is for one of them."""
        path = scope["path"]
        mine = path == self._prefix or path.startswith(f"{self._prefix}/")
        return (Match.FULL if mine and scope["type"] == "http" else Match.NONE), {}

    async def handle(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request."""
        router = await run_in_threadpool(self._made) if self._router is None else self._router
        await router(scope, receive, send)

    def _made(self) -> Router:
        with self._lock:
            if self._router is None:
                self._router = Router(routes=self._make())
            return self._router

"""Bodies of requests: JSON of a size that a page of ours sends, handled beside the loop."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

from starlette.concurrency import run_in_threadpool

from models.errors import ParameterError

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable

    from starlette.requests import Request
    from starlette.responses import Response

__all__ = ["body"]

_MOST = 4 << 20
"""Longest body [byte]."""


def body(answer: Callable[[Request, object], Response]) -> Callable[[Request], Awaitable[Response]]:
    """Return the endpoint that answers a request and the JSON in it.

    Parameters
    ----------
    answer : callable
        From request and body to response; it runs in a thread, so it may take its time.

    Raises
    ------
    ParameterError
        The body is too long or no JSON.
    """

    async def endpoint(request: Request) -> Response:
        read = bytearray()
        async for piece in request.stream():
            read += piece
            if len(read) > _MOST:
                raise ParameterError(f"the request is longer than {_MOST} bytes")
        try:
            said = json.loads(bytes(read) or b"{}")
        except (ValueError, RecursionError):
            raise ParameterError("the request is no JSON") from None
        return await run_in_threadpool(answer, request, said)

    return endpoint

"""Server of the app: its page and the routes of its views."""

from __future__ import annotations

import contextlib
import secrets
import signal
import socket
import threading
from collections.abc import Callable, Sequence
from functools import cache, partial
from importlib import import_module
from pathlib import Path
from threading import Lock
from typing import TYPE_CHECKING

from jinja2 import Environment, PackageLoader
from starlette.applications import Starlette
from starlette.concurrency import run_in_threadpool
from starlette.responses import HTMLResponse, JSONResponse
from starlette.routing import BaseRoute, Mount, Route, Router
from starlette.staticfiles import StaticFiles

from models.errors import BushingNoiseError
from noise.app.gate import Gate
from noise.base.labels import LABEL_LOOKS

if TYPE_CHECKING:
    from starlette.requests import Request
    from starlette.responses import Response
    from starlette.types import ASGIApp, Receive, Scope, Send

    from noise.app.opened import Opened


def lazy_app(make: Callable[[], Sequence[BaseRoute]]) -> ASGIApp:
    """Return an application of routes that are made on the first request, in a thread."""
    made, lock = cache(lambda: Router(routes=make())), Lock()

    def router() -> Router:
        with lock:
            return made()

    async def app(scope: Scope, receive: Receive, send: Send) -> None:
        await (await run_in_threadpool(router))(scope, receive, send)

    return app


VIEWS = {"labels": "Recordings", "design": "Design", "jury": "Jury"}
"""Views in the order of their tabs: folder under ``static``, title."""

_ROUTES = ("noise.app.sounds", "noise.app.label_view", "noise.app.jury_view")
"""Modules of routes besides `noise.app.design_view`, which takes a while to be loaded."""

_STATIC = Path(__file__).parent / "static"


def create_app(
    opened: Opened, token: str, port: int, stop: Callable[[], None] = lambda: None
) -> ASGIApp:
    """Return the ASGI application.

    Parameters
    ----------
    opened : Opened
        Files of the app.
    token : str
        Access token.
    port : int
        Port of the server [-].
    stop : callable
        Called on a request to stop.
    """
    environment = Environment(loader=PackageLoader("noise.app"), autoescape=True)
    first = "design" if opened.rigs and not opened.jobs else "labels"
    page = environment.get_template("page.html.j2").render(
        views=VIEWS, looks=LABEL_LOOKS, first=first
    )

    async def shown(_: Request) -> Response:
        return HTMLResponse(page)

    async def stopped(_: Request) -> Response:
        stop()
        return JSONResponse({"stopped": True})

    def routes_of(module: str) -> list[BaseRoute]:
        module_routes: list[BaseRoute] = import_module(module).routes(opened)
        return module_routes

    routes = [
        Route("/", shown),
        Route("/api/stop", stopped, methods=["POST"]),
        Mount("/static/shared", StaticFiles(packages=[("noise.pages", "templates/shared")])),
        Mount("/static", StaticFiles(directory=_STATIC)),
    ]
    for module in _ROUTES:
        routes += routes_of(module)
    make: Callable[[], Sequence[BaseRoute]] = partial(routes_of, "noise.app.design_view")
    if opened.rigs:  # what is wrong with a rig that is named is told where it was named
        make = partial(list, make())
    routes.append(Mount("/api/design", lazy_app(make)))
    app = Starlette(routes=routes, exception_handlers={BushingNoiseError: _told})
    return Gate(app, token, port)


async def _told(_: Request, error: Exception) -> Response:
    """Return the error as one line of JSON."""
    return JSONResponse({"error": " ".join(str(error).split("\n"))}, 400)


def serve(opened: Opened, port: int, ready: Callable[[str], None]) -> None:
    """Serve on the loopback address until a request or signal stops the server.

    Parameters
    ----------
    opened : Opened
        Files of the app.
    port : int
        Port; 0 selects a free one [-].
    ready : callable
        Called with the address.

    Raises
    ------
    OSError
        The port is in use.
    """
    import uvicorn

    with (
        opened.leaving,
        contextlib.closing(socket.create_server(("127.0.0.1", port))) as listening,
    ):
        # Or every answer would wait 40 ms for the browser to acknowledge its head.
        listening.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        port = listening.getsockname()[1]
        token = secrets.token_urlsafe(24)

        def stop() -> None:
            server.should_exit = True

        app = create_app(opened, token, port, stop)
        server = uvicorn.Server(
            uvicorn.Config(app, log_level="critical", ws="none", timeout_graceful_shutdown=2)
        )
        # In a thread of its own it leaves signals alone; its handlers would end the process before
        # what runs beside it is told to end.
        serving = threading.Thread(target=server.run, kwargs={"sockets": [listening]})
        _stop_on_signals(stop)
        ready(f"http://127.0.0.1:{port}/?token={token}")
        serving.start()
        while serving.is_alive():
            serving.join(0.2)  # without a limit Windows hears no Ctrl-C


def _stop_on_signals(stop: Callable[[], None]) -> None:
    """Stop on signals of the terminal; in another thread than the main one they are not for us."""
    if threading.current_thread() is threading.main_thread():
        for name in ("SIGINT", "SIGTERM", "SIGHUP"):
            if hasattr(signal, name):
                signal.signal(getattr(signal, name), lambda *_: stop())

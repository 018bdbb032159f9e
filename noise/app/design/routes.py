"""Routes: a rig that is heard while it is changed."""

from __future__ import annotations

from typing import TYPE_CHECKING

from starlette.responses import JSONResponse, Response
from starlette.routing import Route

from models.errors import ParameterError
from noise.app.design.bases import base_of, bases_of
from noise.app.design.beside import Beside
from noise.app.design.chart import ChartAsked, HelpAsked, chart_of, helps_of
from noise.app.design.design import base_controls, design_of
from noise.app.design.keeping import Keeping
from noise.app.design.saving import save_rig
from noise.app.design.sound import BLOCK, RATE, TORQUE_STEP, LiveSounds
from noise.app.requests import body
from sim.live import LOOKAHEAD

if TYPE_CHECKING:
    from starlette.requests import Request
    from starlette.routing import BaseRoute

    from noise.app.opened import Opened

__all__ = ["routes"]

_NICE = 5
"""Whoever listens goes first."""


def routes(opened: Opened) -> list[BaseRoute]:
    """Return the routes of this view."""
    bases = bases_of(opened)
    sounds = LiveSounds(bases)
    charts: Beside[ChartAsked, dict[str, object]] = Beside(chart_of, _NICE)
    helps: Beside[HelpAsked, dict[str, object]] = Beside(helps_of, _NICE)
    keeping = Keeping(bases, opened.folder)
    for one in (sounds, charts, helps, keeping):
        opened.leaving.callback(one.stop)

    def listed(_: Request) -> Response:
        named = [{"id": key, "name": base.name} for key, base in bases.items()]
        steps = {"rate": RATE, "block": BLOCK, "torque_step": TORQUE_STEP}
        return JSONResponse({"bases": named, "lookahead_s": LOOKAHEAD, **steps})

    def controls(request: Request) -> Response:
        base = base_of(request.query_params.get("base"), bases)
        return JSONResponse({"controls": [one.as_json() for one in base_controls(base)]})

    def block(_: Request, said: object) -> Response:
        return Response(sounds.block(said), media_type="application/octet-stream")

    def told(_: Request, said: object) -> Response:
        design = design_of(said, bases)
        facts = {"facts": design.facts(), "remarks": design.remarks(), "options": design.options}
        return JSONResponse(facts)

    def levels(request: Request) -> Response:
        said = request.query_params.get("run", "")
        if not said.isdecimal():
            raise ParameterError(f"sound: run {said[:20]!r} is no number")
        return JSONResponse(sounds.levels(int(said)))

    def charted(_: Request, said: object) -> Response:
        return _waited(charts.answer_to(ChartAsked.of(design_of(said, bases).setting)))

    def helped(_: Request, said: object) -> Response:
        return _waited(helps.answer_to(HelpAsked.of(design_of(said, bases).setting, said)))

    def kept(_: Request, said: object) -> Response:
        return JSONResponse(keeping.start(said))

    def saved(_: Request, said: object) -> Response:
        return JSONResponse(save_rig(said, bases, opened.folder))

    return [
        Route("/api/design", listed),
        Route("/api/design/controls", controls),
        Route("/api/design/block", body(block), methods=["POST"]),
        Route("/api/design/facts", body(told), methods=["POST"]),
        Route("/api/design/levels", levels),
        Route("/api/design/chart", body(charted), methods=["POST"]),
        Route("/api/design/helps", body(helped), methods=["POST"]),
        Route("/api/design/rig", body(saved), methods=["POST"]),
        Route("/api/design/set", body(kept), methods=["POST"]),
        Route("/api/design/set", lambda _: JSONResponse(keeping.state()), methods=["GET"]),
    ]


def _waited(answer: tuple[dict[str, object] | None, str] | None) -> Response:
    """Answer what is known by now: the page asks again until it is."""
    found, error = answer or (None, "")
    return JSONResponse({"known": answer is not None, "found": found, "error": error})

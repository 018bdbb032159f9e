"""Routes of the view Design: live sound of a rig."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from starlette.responses import JSONResponse, Response, StreamingResponse
from starlette.routing import Route

from models.errors import ParameterError
from noise.app.design import design_of, save_rig
from noise.app.design_chart import ChartRequest
from noise.app.design_controls import base_of, bases_of
from noise.app.design_player import BLOCK, RATE, TORQUE_STEP
from noise.app.design_sound import LiveSounds
from noise.app.gate import body
from noise.app.requests import number
from noise.app.worker_process import WorkerProcess

if TYPE_CHECKING:
    from starlette.requests import Request
    from starlette.routing import BaseRoute

    from noise.app.opened import Opened


_CHARTS = "noise.app.design_chart"
_NICE = 2
"""Whoever listens goes first, but whoever waits for a map is served on a busy machine, too."""


def routes(opened: Opened) -> list[BaseRoute]:
    """Return the routes of this view."""
    bases = bases_of(opened)
    sounds = LiveSounds(bases)
    charts: WorkerProcess[ChartRequest, dict[str, object]] = WorkerProcess(
        f"{_CHARTS}:chart_of", _NICE
    )
    for one in (sounds, charts):
        opened.leaving.callback(one.stop)

    def listed(_: Request) -> Response:
        sounds.get_ready()
        named = [{"id": key, "name": base.name} for key, base in bases.items()]
        about = {"bases": named, "rate": RATE, "block": BLOCK, "torque_step": TORQUE_STEP}
        return JSONResponse(about)

    def controls(request: Request) -> Response:
        base = base_of(request.query_params.get("base"), bases)
        return JSONResponse({"controls": [one.as_json() for one in base.controls]})

    def sound(_: Request, request: dict[str, Any]) -> Response:
        blocks = sounds.stream(*sounds.started(request))
        return StreamingResponse(blocks, media_type="application/octet-stream")

    def changed(_: Request, request: dict[str, Any]) -> Response:
        sounds.change(request)
        return JSONResponse({})

    def facts_of(_: Request, request: dict[str, Any]) -> Response:
        design = design_of(request, bases)
        facts = {"facts": design.facts(), "remarks": design.remarks(), "options": design.options}
        return JSONResponse(facts)

    def levels(request: Request) -> Response:
        run = request.query_params.get("run", "")
        if not run.isdecimal():
            raise ParameterError(f"sound: run {run[:20]!r} is no number")
        return JSONResponse(sounds.levels(int(run)))

    def charted(_: Request, request: dict[str, Any]) -> Response:
        setting = design_of(request, bases).setting
        detail = int(number(request, "detail", 0, 2, 2, whole=True))
        question = ChartRequest(setting.rig, setting.support_stiffness, setting.temperature, detail)
        answer = charts.answer_to(question)  # the page polls until the result is known
        result, error = answer or (None, "")
        known, share = answer is not None, charts.share_of(question)
        return JSONResponse({"known": known, "found": result, "error": error, "share": share})

    def saved(_: Request, request: dict[str, Any]) -> Response:
        return JSONResponse(save_rig(request, bases, opened.folder))

    return [
        Route("/api/design", listed),
        Route("/api/design/controls", controls),
        Route("/api/design/sound", body(sound), methods=["POST"]),
        Route("/api/design/change", body(changed), methods=["POST"]),
        Route("/api/design/facts", body(facts_of), methods=["POST"]),
        Route("/api/design/levels", levels),
        Route("/api/design/chart", body(charted), methods=["POST"]),
        Route("/api/design/rig", body(saved), methods=["POST"]),
    ]

"""Routes: a rig that is heard while it is changed."""

from __future__ import annotations

from typing import TYPE_CHECKING

from starlette.responses import JSONResponse, Response
from starlette.routing import Route

from models.errors import ParameterError
from noise.app.design.bases import base_of, bases_of
from noise.app.design.design import base_controls, design_of
from noise.app.design.saving import save_rig
from noise.app.design.sound import BLOCK, RATE, TORQUE_STEP, LiveSounds
from noise.app.requests import body
from sim.live import LOOKAHEAD

if TYPE_CHECKING:
    from starlette.requests import Request
    from starlette.routing import BaseRoute

    from noise.app.opened import Opened

__all__ = ["routes"]


def routes(opened: Opened) -> list[BaseRoute]:
    """Return the routes of this view."""
    bases = bases_of(opened)
    sounds = LiveSounds(bases)
    opened.leaving.callback(sounds.stop)

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

    def saved(_: Request, said: object) -> Response:
        return JSONResponse(save_rig(said, bases, opened.folder))

    return [
        Route("/api/design", listed),
        Route("/api/design/controls", controls),
        Route("/api/design/block", body(block), methods=["POST"]),
        Route("/api/design/facts", body(told), methods=["POST"]),
        Route("/api/design/levels", levels),
        Route("/api/design/rig", body(saved), methods=["POST"]),
    ]

"""View Design: routes, and the live sound as a stream of blocks that follows its changes.

Blocks are sent when they are due: the page buffers little, so changes are audible soon.
"""

from __future__ import annotations

import asyncio
import gc
import math
import time
from collections import deque
from collections.abc import AsyncIterator
from contextlib import suppress
from dataclasses import asdict, dataclass, field
from functools import cache
from threading import Lock, Thread
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from starlette.responses import JSONResponse, Response, StreamingResponse
from starlette.routing import Route

from features.kernels.weighting import sound_levels
from models.condition import Condition
from models.errors import ParameterError
from models.recording import Channel, Recording
from noise.app.design import Design, design_of, save_rig
from noise.app.design_chart import ChartRequest
from noise.app.design_controls import Base, base_of, bases_of
from noise.app.design_player import BLOCK, HEADER, RATE, REFUSED, TORQUE_STEP, play
from noise.app.gate import body
from noise.app.requests import number
from noise.app.worker_process import WorkerProcess, process_context
from noise.base.processes import interrupts_blocked

if TYPE_CHECKING:
    from multiprocessing.connection import Connection
    from multiprocessing.process import BaseProcess

    from starlette.requests import Request
    from starlette.routing import BaseRoute

    from noise.app.opened import Opened
    from noise.classifier import Classifier

_CHARTS = "noise.app.design_chart"
_CHART_NICE = 2
"""Whoever listens goes first, but whoever waits for a map is served on a busy machine, too."""


def routes(opened: Opened) -> list[BaseRoute]:
    """Return the routes of this view."""
    bases = bases_of(opened)
    sounds = LiveSounds(bases)
    charts: WorkerProcess[ChartRequest, dict[str, object]] = WorkerProcess(
        f"{_CHARTS}:chart_of", _CHART_NICE
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
        return JSONResponse({"controls": [asdict(one) for one in base.controls]})

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
        Route("/", listed),
        Route("/controls", controls),
        Route("/sound", body(sound), methods=["POST"]),
        Route("/change", body(changed), methods=["POST"]),
        Route("/facts", body(facts_of), methods=["POST"]),
        Route("/levels", levels),
        Route("/chart", body(charted), methods=["POST"]),
        Route("/rig", body(saved), methods=["POST"]),
    ]


_METER = RATE // BLOCK
"""Blocks per second, over which level and noise are shown."""

_Named: TypeAlias = tuple[int, float, float, bytes]
"""Question of `name_of`."""

_NICE = 5
"""Niceness of the process that names the noise."""

_MOST_RUNS = 4
"""Maximum number of simultaneous runs."""

_PATIENCE = 5.0
"""Time for the player to end by itself [s]."""

_UNREAD = 5 * _METER
"""Unread blocks after which a stream is abandoned."""


@dataclass(eq=False)
class _Stream:
    loop: asyncio.AbstractEventLoop
    queue: asyncio.Queue[bytes | None] = field(default_factory=asyncio.Queue)
    recent: deque[bytes] = field(default_factory=lambda: deque(maxlen=_METER))
    speed: float = 0.0

    def put(self, message: bytes) -> None:
        """Queue a message of the player; an empty message ends the stream."""
        if message and HEADER.unpack_from(message)[0] != REFUSED:
            self.recent.append(message[HEADER.size : HEADER.size + 4 * BLOCK])
            self.speed = HEADER.unpack_from(message)[4]
        given_up = not message or self.queue.qsize() > _UNREAD
        with suppress(RuntimeError):  # the loop has ended
            self.loop.call_soon_threadsafe(self.queue.put_nowait, None if given_up else message)


class LiveSounds:
    """Live runs, one per page.

    Parameters
    ----------
    bases : dict of str to Base
        Bases of designs.
    """

    def __init__(self, bases: dict[str, Base]) -> None:
        self._bases = bases
        self._lock = Lock()
        self._streams: dict[int, _Stream] = {}
        self._link: Connection | None = None
        self._player: BaseProcess
        self._names: WorkerProcess[_Named, dict[str, object]] = WorkerProcess(
            f"{__name__}:name_of", _NICE
        )

    def get_ready(self) -> None:
        """Start the player process, if it is not running."""
        with self._lock:
            if self._link is not None:
                return
            context = process_context()
            self._link, theirs = context.Pipe()
            # No daemon, since it has a process beside itself; it ends with the link.
            with interrupts_blocked():
                self._player = context.Process(target=play, args=(theirs,))  # type: ignore[attr-defined]
                self._player.start()
            theirs.close()
            sound_levels(np.zeros(RATE), RATE)  # compiled now, not while it plays
            gc.collect()
            gc.freeze()  # or all that is loaded is walked through while it plays
            Thread(target=self._read, args=(self._link,), daemon=True).start()
        # The first name is not to wait for the model.
        self._names.ask((0, 0.0, 0.0, bytes(4 * RATE)))

    def stop(self) -> None:
        """End all streams and the player."""
        self._names.stop()
        with self._lock:
            link, self._link = self._link, None
        if link is not None:
            with suppress(OSError):
                link.send(None)
            self._player.join(_PATIENCE)
            self._player.kill()

    def started(self, request: dict[str, Any]) -> tuple[int, int, Design]:
        """Parse number, serial and design of a request that starts or changes a run.

        Parameters
        ----------
        request : dict
            ``{"run": number, "serial": number, "design": {...}}``; `serial` counts changes.

        Raises
        ------
        ParameterError
            The request is invalid.
        """
        number, serial = (_whole(request, key) for key in ("run", "serial"))
        stated = request.get("design")
        return number, serial, design_of(stated, self._bases)

    async def stream(self, number: int, serial: int, design: Design) -> AsyncIterator[bytes]:
        """Yield the blocks of `noise.app.design_player.Player.block` until the page disconnects."""
        stream = _Stream(asyncio.get_running_loop())
        while len(self._streams) >= _MOST_RUNS:
            self._streams.pop(next(iter(self._streams))).put(b"")
        self._streams[number] = stream
        try:
            self.get_ready()
            self._tell("start", number, serial, design.setting)
            while (message := await stream.queue.get()) is not None:
                yield message
        finally:
            self._tell("stop", number)
            if self._streams.get(number) is stream:
                del self._streams[number]

    def change(self, request: dict[str, Any]) -> None:
        """Change the design from the next block on; `request` as of `started`.

        Raises
        ------
        ParameterError
            The request is invalid; the run continues unchanged.
        """
        number, serial, design = self.started(request)
        self._known(number)
        self._tell("change", number, serial, design.setting)

    def levels(self, number: int) -> dict[str, object]:
        """Return the levels [dB re 20 uPa] and the noise of the last second of a run.

        The noise is that of an earlier second, because classification takes time; ``name_age_s``
        is how long ago that second ended.
        """
        stream = self._streams.get(number)
        recent = b"".join(stream.recent.copy()) if stream is not None else b""
        pressure = np.frombuffer(recent, "<f4").astype(np.float64)
        if pressure.size < RATE // 4:
            return {"level_dba": None, "l_afmax_dba": None}
        newest = self._names.newest
        name = None
        if newest is not None and newest[0][0] == number and newest[1] is not None:
            name = newest[1] | {"name_age_s": time.monotonic() - newest[0][1]}
        if stream is not None and len(stream.recent) == _METER and not self._names.busy:
            self._names.ask((number, time.monotonic(), stream.speed, recent))
        measured = sound_levels(pressure, RATE)
        levels = {
            "level_dba": measured.level_a,
            "l_afmax_dba": measured.level_af_max,
        }
        return (name or {}) | {
            key: round(value, 1) if math.isfinite(value) else None for key, value in levels.items()
        }

    def _known(self, number: int) -> None:
        if number not in self._streams:
            raise ParameterError("sound: there is no such run; begin another one")

    def _tell(self, what: str, number: int, *rest: object) -> None:
        with self._lock, suppress(OSError):  # the player is gone, which ends the streams
            if self._link is not None:
                self._link.send((what, number, *rest))

    def _read(self, link: Connection) -> None:
        with suppress(EOFError, OSError):
            while True:
                message = link.recv_bytes()
                stream = self._streams.get(int.from_bytes(message[:4], "little"))
                if stream is not None:
                    stream.put(message[4:])
        with self._lock:
            if self._link is link:
                self._link = None
        for stream in list(self._streams.values()):
            stream.put(b"")


def name_of(question: _Named) -> dict[str, object]:
    """Return the label and frequency [Hz] of the last second of a run.

    Parameters
    ----------
    question : tuple of (int, float, float, bytes)
        Number of the run, time of its last sample [s], speed [rad/s], sound pressure as 32-bit
        floats [Pa].

    Examples
    --------
    >>> name_of((1, 0.0, 5.0, bytes(4 * 48000)))
    {'label': 'none', 'frequency_hz': None}
    """
    from noise.labels.segments import file_label, label_recording

    _, _, speed, samples = question
    pressure = np.frombuffer(samples, "<f4").astype(np.float64)
    run = Recording(
        pressure[None], RATE, (Channel("pressure"),), Condition(speed=speed), calibrated=True
    )
    segment = file_label(label_recording(run, _classifier()))
    return {"label": segment.label, "frequency_hz": segment.frequency}


@cache
def _classifier() -> Classifier:
    """Return the shipped classifier, loaded once per process."""
    from noise.classifier import load_classifier

    return load_classifier()


def _whole(request: dict[str, Any], key: str) -> int:
    return int(number(request, key, 0, (1 << 32) - 1, whole=True))

"""Process that simulates live designs in real time, block by block.

It does nothing else, so other work cannot delay the sound. A change takes effect in the next block.
Impulse responses from torque to microphone take longer; another process computes them, and they are
used as soon as they are available.
"""

from __future__ import annotations

import gc
import signal
import struct
import sys
import time
from contextlib import suppress
from dataclasses import dataclass, field, replace
from multiprocessing import get_context
from typing import TYPE_CHECKING

from models.errors import ParameterError
from models.radiation.impulse_responses import ImpulseResponses
from models.rig_file import load_material_rig
from noise.app.worker_process import WorkerProcess
from noise.batch.work import one_thread
from sim.live import LiveSimulation, paths_key, paths_of
from sim.plan import Setting
from sim.shaft import ConstantSpeed

if TYPE_CHECKING:
    from multiprocessing.connection import Connection
    from multiprocessing.context import BaseContext

RATE = 48000
"""Sampling rate of the sound [Hz]."""


_NICE = 10
"""Niceness of the process that computes impulse responses."""


@dataclass(frozen=True)
class PathsQuestion:
    """Request of impulse responses: a setting and its `sim.live.paths_key`, which is compared."""

    key: tuple[object, ...]
    setting: Setting = field(compare=False)


def block_impulse_responses(question: PathsQuestion) -> ImpulseResponses:
    """Return the impulse responses of a setting at the rate of its blocks."""
    return paths_of(question.setting, RATE)


class LiveTransferPaths:
    """Impulse responses of one run, computed in another process except for the first.

    Parameters
    ----------
    beside : WorkerProcess
        Computes them.
    """

    refusal = ""
    """Reason why the impulse responses of the newest setting failed; empty if they did not."""

    def __init__(self, beside: WorkerProcess[PathsQuestion, ImpulseResponses]) -> None:
        self._beside = beside
        self._known: tuple[tuple[object, ...], ImpulseResponses] | None = None
        self._wanted: PathsQuestion | None = None

    def __call__(self, setting: Setting) -> ImpulseResponses | None:
        """Return the impulse responses of a setting; None while they are computed."""
        if self._wanted is None or self._wanted.setting is not setting:
            self._wanted, self.refusal = PathsQuestion(paths_key(setting), setting), ""
        key = self._wanted.key
        if self._known is None:
            self._known = key, paths_of(setting, RATE)
        if key == self._known[0]:
            return self._known[1]
        answer = None if self.refusal else self._beside.answer_to(self._wanted)
        if answer is None:
            return None
        responses, self.refusal = answer
        if responses is not None:
            self._known = key, responses
        return responses


_BEHIND = 0.2
"""Delay beyond which the schedule restarts instead of catching up [s]."""


class Pace:
    """Schedule of the blocks of one run.

    Parameters
    ----------
    step : float
        Duration of a block [s].

    Examples
    --------
    >>> pace = Pace(0.02)
    >>> pace.early(0, 100.0), pace.early(1, 101.0)
    (0.0, 0.0)
    >>> round(pace.early(2, 101.005), 3)
    0.015
    """

    def __init__(self, step: float) -> None:
        self._step = step
        self._begun: float | None = None

    def early(self, sequence: int, now: float) -> float:
        """Return the time until a block is due [s].

        The clock starts after the first block, which may take longer than all others.
        """
        if sequence == 0:
            return 0.0
        since = sequence * self._step
        if self._begun is None or now - self._begun - since > _BEHIND:
            self._begun = now - since
        return max(0.0, self._begun + since - now)


BLOCK = 960
"""Samples per block: 20 ms."""

TORQUE_STEP = 4
"""Decimation of the torque, which is only drawn."""

HEADER = struct.Struct("<4If")
"""Header of a block."""

REFUSED = 0xFFFFFFFF
"""Sequence number of a message that refuses a change; n bytes of UTF-8 follow."""


@dataclass(eq=False)
class _Run:
    live: LiveSimulation
    paths: LiveTransferPaths
    serial: int
    refused: int = -1
    change: tuple[int, Setting] | None = None
    sequence: int = 0
    pace: Pace = field(default_factory=lambda: Pace(BLOCK / RATE))


class Player:
    """Live runs by number.

    Parameters
    ----------
    context : multiprocessing.context.BaseContext, optional
        In which the process that computes impulse responses is started.
    """

    def __init__(self, context: BaseContext | None = None) -> None:
        self._runs: dict[int, _Run] = {}
        self.beside: WorkerProcess[PathsQuestion, ImpulseResponses] = WorkerProcess(
            f"{__name__}:block_impulse_responses", _NICE, context
        )

    def start(self, number: int, serial: int, setting: Setting) -> None:
        """Start a run.

        Raises
        ------
        ParameterError
            The setting is invalid.
        """
        paths = LiveTransferPaths(self.beside)
        self._runs[number] = _Run(LiveSimulation(setting, paths, n=BLOCK), paths, serial)

    def stop(self, number: int) -> None:
        """End a run, if it exists."""
        self._runs.pop(number, None)

    def change(self, number: int, serial: int, setting: Setting) -> None:
        """Change the setting from the next block on."""
        if run := self._runs.get(number):
            run.change = serial, setting

    def due(self, now: float) -> tuple[float, int] | None:
        """Return the time until the next block is due [s] and its run; None without runs."""
        waits = ((run.pace.early(run.sequence, now), n) for n, run in self._runs.items())
        return min(waits, default=None)

    def block(self, number: int) -> bytes:
        """Return the next block of a run.

        Returns
        -------
        bytes
            Sequence, serial, samples of pressure and of torque as unsigned integers; speed of the
            shaft [rad/s], then pressure [Pa] and torque [Nm] as
            floating-point numbers; all of 32 bits, little-endian. Where the change that was to be
            heard could not be, or what carries it to the microphone cannot, `REFUSED` and why comes
            before it.

        Raises
        ------
        ParameterError
            The run failed.
        """
        run = self._runs[number]
        why = b""
        change, run.change = run.change, None
        if change is None:
            made = run.live.block()
        else:
            run.serial, setting = change
            try:
                made = run.live.block(setting)
            except ParameterError as error:
                why = refusal(run.serial, error)
                made = run.live.block()
        if run.paths.refusal and run.refused != run.serial:
            why += refusal(run.serial, run.paths.refusal)
            run.refused = run.serial
        pressure = made.pressure.astype("<f4")
        torque = made.torque[::TORQUE_STEP].astype("<f4")
        sizes = pressure.size, torque.size
        header = HEADER.pack(run.sequence, run.serial, *sizes, made.speed)
        run.sequence += 1
        return why + header + pressure.tobytes() + torque.tobytes()


def refusal(serial: int, error: ParameterError | str) -> bytes:
    """Return the message that refuses a change."""
    why = " ".join(str(error).split()).encode()
    return HEADER.pack(REFUSED, serial, len(why), 0, 0.0) + why


def warmed(context: BaseContext | None = None) -> Player:
    """Return a player whose code is compiled; `context` as of `Player`."""
    player = Player(context)
    setting = Setting(load_material_rig("fluorocarbon"), ConstantSpeed(5.0), 0.3e-3, 2214.0)
    player.beside.ask(PathsQuestion(paths_key(setting), setting))
    player.start(0, 0, setting)
    player.block(0)
    player.change(0, 1, replace(setting, shaft=ConstantSpeed(6.0), interference=0.31e-3))
    player.block(0)
    player.stop(0)
    gc.collect()
    gc.freeze()  # or all that is loaded is walked through while it plays
    return player


def play(link: Connection) -> None:
    """Execute commands from a connection until None arrives or it is closed.

    Parameters
    ----------
    link : Connection
        Gives ``(what, number, ...)``: a method of `Player` and its arguments; takes the number of a
        run in four bytes, little-endian, and a message of it after that: none is left where there
        is only the number.
    """
    with suppress(ValueError):  # a key in the terminal is for the server
        signal.signal(signal.SIGINT, signal.SIG_IGN)
    with one_thread(), suppress(EOFError, OSError):
        # A copy of this process, which has no threads yet, is there at once.
        player = warmed(get_context("fork") if sys.platform == "linux" else None)
        try:
            while True:
                due = player.due(time.perf_counter())
                if link.poll(None if due is None else due[0]):
                    command = link.recv()
                    if command is None:
                        return
                    what, number, *rest = command
                else:
                    what, number, rest = "", due[1] if due else 0, []
                _do(player, link, what, number, rest)
        finally:
            player.beside.stop()


def _do(player: Player, link: Connection, what: str, number: int, rest: list[object]) -> None:
    name = number.to_bytes(4, "little")
    try:
        if what:
            getattr(player, what)(number, *rest)
        else:
            link.send_bytes(name + player.block(number))
    except ParameterError as error:
        player.stop(number)
        serial = rest[0] if rest and isinstance(rest[0], int) else 0
        link.send_bytes(name + refusal(serial, error))
        link.send_bytes(name)

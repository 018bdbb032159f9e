"""The sound of a design while it is changed: blocks of one run that goes on, by request.

A page asks for one block after another, and with any of them may come another design, which is
heard from that block on. So the page alone decides how far ahead it is. What carries the torque to
the microphone takes a while to be computed: that is done beside, and takes over when it is known.
"""

from __future__ import annotations

import math
import struct
import time
from collections import OrderedDict
from dataclasses import dataclass, field
from threading import Condition, Lock
from typing import TYPE_CHECKING

import numpy as np

from features.kernels.levels import sound_levels
from models.errors import ParameterError
from noise.app.design.beside import Beside
from noise.app.design.design import Design, design_of
from sim.live import LiveRun, paths_key, paths_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from models.radiation.impulse_responses import ImpulseResponses
    from noise.app.design.bases import Base
    from sim.live import Setting

__all__ = ["BLOCK", "RATE", "LiveSounds"]

RATE = 48000
"""Of the sound [Hz]."""

BLOCK = 960
"""Samples of a block: 20 ms."""

TORQUE_STEP = 4
"""Of every so many samples of the torque one is sent, to be drawn."""

_METER = 1.0
"""Of the sound, over which its level is told [s]."""

_NICE = 3
"""The sound goes on before what carries it is another."""

_PATIENCE = 2.0
"""For blocks that come before one that was asked for too early [s]."""

_MOST_RUNS = 4
"""That go on at once: of pages that are open."""

_HEADER = struct.Struct("<4I2f")


def block_paths(setting: Setting) -> ImpulseResponses:
    """Return the impulse responses of a setting at the rate of its blocks."""
    return paths_of(setting, RATE)


class _Paths:
    """Impulse responses for one run, computed beside; the first at once."""

    def __init__(self, beside: Beside[Setting, ImpulseResponses]) -> None:
        self._beside = beside
        self._known: tuple[tuple[object, ...], ImpulseResponses] | None = None
        self._wanted: tuple[Setting, tuple[object, ...]] | None = None
        self._asked: dict[int, tuple[Setting, tuple[object, ...]]] = {}

    def __call__(self, setting: Setting) -> ImpulseResponses | None:
        if self._known is None:
            self._known = paths_key(setting), block_paths(setting)
        if self._wanted is None or self._wanted[0] is not setting:
            self._wanted = setting, paths_key(setting)
        key = self._wanted[1]
        if key == self._known[0]:
            return self._known[1]
        newest = self._beside.newest
        mine = None if newest is None else self._asked.pop(id(newest[0]), None)
        if newest is not None and mine is not None and newest[1] is not None:
            self._known = mine[1], newest[1]
            return newest[1]
        if mine is None and not any(asked == key for _, asked in self._asked.values()):
            self._ask(setting, key)
        elif not self._beside.busy:  # what another page asked for took its place
            self._asked.clear()
        return None

    def _ask(self, setting: Setting, key: tuple[object, ...]) -> None:
        self._asked[id(setting)] = setting, key
        self._beside.ask(setting)


@dataclass(eq=False)
class _Run:
    live: LiveRun
    design: Design
    sequence: int = 0
    turn: Condition = field(default_factory=Condition)
    heard: NDArray[np.float64] = field(default_factory=lambda: np.zeros(0))


class LiveSounds:
    """Runs that go on, each for one page.

    Parameters
    ----------
    bases : dict of str to Base
        That designs name.
    """

    def __init__(self, bases: dict[str, Base]) -> None:
        self._bases = bases
        self._runs: OrderedDict[int, _Run] = OrderedDict()
        self._lock = Lock()
        self._beside: Beside[Setting, ImpulseResponses] = Beside(block_paths, _NICE)

    def stop(self) -> None:
        """End what is computed beside."""
        self._beside.stop()

    def block(self, said: object) -> bytes:
        """Return the next block of a run.

        Parameters
        ----------
        said : object
            ``{"run": number, "sequence": number, "serial": number, "design": {...}}``; the design
            comes with the first block and where it has changed, and `serial` counts changes.

        Returns
        -------
        bytes
            Sequence, serial, samples of pressure and of torque as unsigned integers of 32 bits;
            milliseconds that it took and speed of the shaft [rad/s], then pressure [Pa] and torque
            [Nm] as floating-point numbers of 32 bits; all little-endian.

        Raises
        ------
        ParameterError
            Something of it cannot be; the run goes on as it was with the next request.
        """
        number, sequence, serial = (_whole(said, key) for key in ("run", "sequence", "serial"))
        stated = said.get("design") if isinstance(said, dict) else None
        design = None if stated is None else design_of(stated, self._bases)
        run = self._run(number, sequence, design)
        with run.turn:
            run.turn.wait_for(lambda: sequence <= run.sequence, _PATIENCE)
            if sequence != run.sequence:
                raise ParameterError(f"sound: block {sequence} was asked for, not {run.sequence}")
            started = time.perf_counter()
            made = run.live.block(None if design is None else design.setting)
            run.design = design or run.design
            pressure = made.pressure.astype("<f4")
            torque = made.torque[::TORQUE_STEP].astype("<f4")
            run.heard = np.concatenate([run.heard, made.pressure])[-round(_METER * RATE) :]
            took = 1e3 * (time.perf_counter() - started)
            header = _HEADER.pack(sequence, serial, pressure.size, torque.size, took, made.speed)
            run.sequence = sequence + 1
            run.turn.notify_all()
        return header + pressure.tobytes() + torque.tobytes()

    def levels(self, number: int) -> dict[str, float | None]:
        """Return levels of the last second of a run, as the tables have them [dB re 20 uPa]."""
        run = self._runs.get(number)
        if run is None or run.heard.size < RATE // 4:
            return {"level_db": None, "level_dba": None, "l_afmax_dba": None}
        found = sound_levels(run.heard, RATE)
        told = {
            "level_db": found.level, "level_dba": found.level_a, "l_afmax_dba": found.level_af_max,
        }  # fmt: skip
        return {
            name: round(value, 1) if math.isfinite(value) else None for name, value in told.items()
        }

    def _run(self, number: int, sequence: int, design: Design | None) -> _Run:
        with self._lock:
            run = self._runs.get(number)
            if run is None:
                if design is None or sequence != 0:
                    raise ParameterError("sound: there is no such run; begin another one")
                live = LiveRun(design.setting, rate=RATE, n=BLOCK, paths=_Paths(self._beside))
                run = self._runs[number] = _Run(live, design)
            self._runs.move_to_end(number)
            while len(self._runs) > _MOST_RUNS:
                self._runs.popitem(last=False)
            return run


def _whole(said: object, key: str) -> int:
    value = said.get(key) if isinstance(said, dict) else None
    if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value < 1 << 32:
        raise ParameterError(f"sound: {key} must be a whole number from 0 on")
    return value

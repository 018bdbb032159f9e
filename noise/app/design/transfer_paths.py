"""Impulse responses for a run that is heard, computed in a process beside it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from noise.app.design.worker_process import WorkerProcess
from sim.live_setting import paths_key, paths_of

if TYPE_CHECKING:
    from models.radiation.impulse_responses import ImpulseResponses
    from sim.live_setting import Setting

    ImpulseResponseWorker = WorkerProcess[Setting, ImpulseResponses]

__all__ = ["RATE", "LiveTransferPaths", "block_impulse_responses", "impulse_response_worker"]

RATE = 48000
"""Of the sound [Hz]."""

_NICE = 10
"""The sound goes on before what carries it is another."""


def block_impulse_responses(setting: Setting) -> ImpulseResponses:
    """Return the impulse responses of a setting at the rate of its blocks."""
    return paths_of(setting, RATE)


def impulse_response_worker() -> ImpulseResponseWorker:
    """Return a process that computes impulse responses."""
    return WorkerProcess(f"{__name__}:block_impulse_responses", _NICE)


class LiveTransferPaths:
    """Impulse responses for one run, computed beside; the first at once."""

    def __init__(self, beside: ImpulseResponseWorker) -> None:
        self._beside = beside
        self._known: tuple[tuple[object, ...], ImpulseResponses] | None = None
        self._wanted: tuple[Setting, tuple[object, ...]] | None = None
        self._asked: dict[int, tuple[Setting, tuple[object, ...]]] = {}
        self._refused: tuple[tuple[object, ...], str] | None = None

    @property
    def refusal(self) -> str:
        """Why those of the setting that was asked for last cannot be, as far as that is known."""
        refused, wanted = self._refused, self._wanted
        return refused[1] if refused and wanted and refused[0] == wanted[1] else ""

    def __call__(self, setting: Setting) -> ImpulseResponses | None:
        """Return those of a setting, None while they are not known."""
        if self._known is None:
            self._known = paths_key(setting), paths_of(setting, RATE)
        if self._wanted is None or self._wanted[0] is not setting:
            self._wanted = setting, paths_key(setting)
        key = self._wanted[1]
        if key == self._known[0]:
            return self._known[1]
        newest = self._beside.newest
        mine = None if newest is None else self._asked.pop(id(newest[0]), None)
        if newest is not None and mine is not None:
            if newest[1] is not None:
                self._known = mine[1], newest[1]
                return newest[1]
            self._refused = mine[1], newest[2]
        if self.refusal:  # asking again would bring no other answer
            return None
        if mine is None and not any(asked == key for _, asked in self._asked.values()):
            self._ask(setting, key)
        elif not self._beside.busy:  # what another page asked for took its place
            self._asked.clear()
        return None

    def _ask(self, setting: Setting, key: tuple[object, ...]) -> None:
        self._asked[id(setting)] = setting, key
        self._beside.ask(setting)

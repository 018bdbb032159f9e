"""Routes of the view Jury: sounds compared blind.

While votes are given, nothing that is answered tells what is heard: a sound is asked for by the
number of its comparison and its side, and comes without a name, at the gain that all have.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from threading import Lock
from typing import Any

import numpy as np
from numpy.typing import NDArray
from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import BaseRoute, Route

from models.errors import BushingNoiseError, ParameterError
from models.recording import REFERENCE_PRESSURE
from noise.app.gate import body
from noise.app.jury import VOTES, Jury, Votes, in_words, scale
from noise.app.opened import Opened
from noise.app.requests import choice, number, text
from noise.app.sounds import SoundCache
from noise.audio.gain import (
    LOUDNESS_BLOCK,
    QUIETEST_FULL_SCALE,
    full_scale_without_clipping,
    loudness,
    matched_loudness,
    true_peak,
)
from noise.audio.sound import playable
from noise.recordings.wav import wav_bytes

MOST = 40
"""Sounds that are compared."""

LONGEST = 30.0
"""Of what is heard of a recording, from its beginning [s]."""

ONE_GAIN, EQUAL_LOUDNESS = GAINS = ("one gain", "equal loudness")
"""How sounds are played: as recorded, the louder louder; or each as loud as the others."""

_LONGEST_TEXT = 200
_LONGEST_WAIT = 1e6
"""Between a comparison and its vote [s]."""

_RATE = 48000
"""Of samples to play [Hz]."""


def routes(opened: Opened) -> list[BaseRoute]:
    """Return the routes of this view."""
    votes = Votes(opened.folder / "votes.csv")
    if opened.table is not None:  # where votes were written before
        before = opened.table.absolute().with_name("votes.csv")
        votes = Votes(before) if before.exists() else votes
    playing = JuryPlaying(opened, SoundCache(opened))
    by_name: dict[str, list[int]] = {}
    for job in opened.jobs:
        by_name.setdefault(job.name, []).append(job.index)

    def indices(names: Sequence[str]) -> list[int]:
        for name in names:
            if len(by_name.get(name, ())) != 1:
                what = "is not open" if name not in by_name else "is the name of several recordings"
                raise ParameterError(f"{name}: {what}; open the folder that the jury is of")
        return [by_name[name][0] for name in names]

    def state(jury: Jury) -> dict[str, object]:
        return {
            "jury": jury.number, "listener": jury.listener, "question": jury.question,
            "played": jury.played, "sounds": len(jury.sounds), "total": len(jury.pairs),
            "waiting": jury.waiting,
            "open": all(len(by_name.get(name, ())) == 1 for name in jury.sounds),
        }  # fmt: skip

    def asked(request: Request) -> Jury:
        return votes.jury(request.path_params["jury"])

    def juries(_: Request) -> Response:
        listed = [state(jury) for jury in votes.juries()]
        return JSONResponse({"juries": listed, "most": MOST, "longest_s": LONGEST})

    def begun(_: Request, setup: dict[str, Any]) -> Response:
        sounds = setup.get("sounds")
        if not isinstance(sounds, list) or not all(type(one) is int for one in sounds):
            raise ParameterError("sounds: must be a list of numbers of recordings")
        chosen = sorted(set(sounds))
        if not 2 <= len(chosen) <= MOST:
            raise ParameterError(f"{len(chosen)} sounds: 2 to {MOST} can be compared")
        question, listener = (text(setup, key, _LONGEST_TEXT) for key in ("question", "listener"))
        if not question:
            raise ParameterError("question: must say what is asked of two sounds")
        played = choice(setup, "played", GAINS, ONE_GAIN)
        pairs = len(chosen) * (len(chosen) - 1) // 2
        comparisons = number(setup, "comparisons", len(chosen) - 1, pairs, pairs, whole=True)
        names = [opened.job(index).name for index in chosen]
        playing.gain(indices(names), played)  # or nobody could begin
        jury = votes.begin(
            names, listener=listener, question=question, played=played, seed=opened.seed,
            comparisons=int(comparisons),
        )  # fmt: skip
        return JSONResponse(state(jury))

    def gone_on(request: Request) -> Response:
        jury = asked(request)
        gain = playing.gain(indices(jury.sounds), jury.played)
        return JSONResponse(state(jury) | {"gain": gain})

    def heard(request: Request) -> Response:
        jury, place = asked(request), request.path_params["place"]
        side = {"a": 0, "b": 1}.get(request.path_params["side"])
        if side is None or place >= len(jury.pairs):
            raise ParameterError("there is no such sound")
        (index,) = indices([jury.pairs[place][side]])
        sound = playing.wav(index, indices(jury.sounds), jury.played)
        return Response(sound, media_type="audio/wav")

    def voted(request: Request, vote: dict[str, Any]) -> Response:
        seconds = number(vote, "seconds", 0.0, _LONGEST_WAIT)
        changed = votes.vote(
            request.path_params["jury"], _place(vote), choice(vote, "vote", VOTES), seconds
        )
        return JSONResponse(state(changed))

    def undone(request: Request, vote: dict[str, Any]) -> Response:
        return JSONResponse(state(votes.undo(request.path_params["jury"], _place(vote))))

    def result(request: Request) -> Response:
        jury = asked(request)
        rows, remarks = scale(jury)
        return JSONResponse(
            state(jury)
            | {"sounds": rows, "words": in_words(rows), "remarks": remarks}
            | {"voted": len(jury.votes)}
        )

    one = "/api/juries/{jury:int}"
    return [
        Route("/api/juries", juries, methods=["GET"]),
        Route("/api/juries", body(begun), methods=["POST"]),
        Route(one, gone_on),
        Route(f"{one}/heard/{{place:int}}/{{side}}", heard),
        Route(f"{one}/vote", body(voted), methods=["POST"]),
        Route(f"{one}/undo", body(undone), methods=["POST"]),
        Route(f"{one}/result", result),
    ]


@dataclass(frozen=True)
class _Measured:
    """A sound: whether in pascals, its true peak [Pa, or full scale], its loudness there [LUFS]."""

    calibrated: bool
    peak: float
    loudness: float | None


class JuryPlaying:
    """Sounds of juries at one gain or equally loud; may be used from several threads.

    Parameters
    ----------
    opened : Opened
    sounds : SoundCache
    """

    def __init__(self, opened: Opened, sounds: SoundCache) -> None:
        self._opened = opened
        self._sounds = sounds
        self._lock = Lock()
        self._measured: dict[tuple[int, int, int], _Measured] = {}

    def gain(self, indices: Sequence[int], played: str) -> str:
        """Say in words at which gain sounds are played.

        Raises
        ------
        BushingNoiseError
            They cannot be played so; it says why.
        """
        if played == EQUAL_LOUDNESS:
            return f"equal loudness, {self._target(indices):.0f} LUFS"
        full_scale = self._full_scale(indices)
        if not self._measure(indices[0]).calibrated:
            return f"one gain: as in the files, full scale = {full_scale:g}"
        level = 20.0 * math.log10(full_scale / REFERENCE_PRESSURE)
        return f"one gain: full scale = {full_scale:g} Pa ({level:.0f} dB peak re 20 µPa)"

    def wav(self, index: int, indices: Sequence[int], played: str) -> bytes:
        """Return one of several sounds as a WAV file of floats, to be played as it is.

        Raises
        ------
        BushingNoiseError
            They cannot be played so; it says why.
        """
        if played == EQUAL_LOUDNESS:
            measured, target = self._measure(index), self._target(indices)
            # A gain shifts loudness by as much, but for the absolute gate, which matters to none
            # that is 10 dB louder.
            full_scale = measured.peak * 10.0 ** (((measured.loudness or 0.0) - target) / 20.0)
        else:
            full_scale = self._full_scale(indices)
        return wav_bytes(self._samples(index) / full_scale, _RATE, 32)

    def _target(self, indices: Sequence[int]) -> float:
        """Return the loudness that all can have [LUFS]."""
        known = []
        for index in indices:
            reached = self._measure(index).loudness
            if reached is None:
                raise ParameterError(
                    f"{self._opened.job(index).name}: has no loudness to be matched, as it is "
                    f"silent or shorter than {LOUDNESS_BLOCK:g} s; leave it out, or play all at "
                    "one gain"
                )
            known.append(reached)
        return matched_loudness(known)

    def _full_scale(self, indices: Sequence[int]) -> float:
        measured = {index: self._measure(index) for index in indices}
        peak = max(one.peak for one in measured.values())
        by_kind: dict[bool, list[int]] = {True: [], False: []}
        for index, one in measured.items():
            by_kind[one.calibrated].append(index)
        if by_kind[True] and by_kind[False]:
            known, other = (self._opened.job(by_kind[kind][0]).name for kind in (True, False))
            raise ParameterError(
                f"{known} is calibrated and {other} is not, so they share no gain; leave one "
                "of them out, or compare at equal loudness"
            )
        least = QUIETEST_FULL_SCALE if by_kind[True] else 1.0
        return max(least, full_scale_without_clipping(peak))

    def _measure(self, index: int) -> _Measured:
        path = self._opened.job(index).path
        try:
            state = path.stat()
        except OSError as error:
            raise ParameterError(f"{path.name}: {error.strerror}") from None
        key = index, state.st_size, state.st_mtime_ns
        with self._lock:
            if key not in self._measured:
                samples = self._samples(index)
                peak = true_peak(samples, _RATE)
                reached = -math.inf
                if peak > 0.0 and samples.size >= LOUDNESS_BLOCK * _RATE:
                    reached = loudness(samples / peak, _RATE)
                self._measured[key] = _Measured(
                    self._sounds.track(index).calibrated,
                    peak,
                    reached if math.isfinite(reached) else None,
                )
            return self._measured[key]

    def _samples(self, index: int) -> NDArray[np.float64]:
        name = self._opened.job(index).name
        try:
            track = self._sounds.track(index)
        except BushingNoiseError as error:
            raise ParameterError(f"{name}: cannot be heard ({error})") from None
        if track.channel.kind != "pressure":
            raise ParameterError(f"{name}: has no sound pressure to be heard; leave it out")
        last = min(track.n, round(LONGEST * track.rate))
        return playable(track.read(0, last), track.rate, _RATE)


def _place(vote: dict[str, Any]) -> int:
    return int(number(vote, "place", 0, 1 << 31, whole=True))

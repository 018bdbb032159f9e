"""Routes of the view Jury: blind comparisons of sounds.

While votes are given, nothing that is answered tells what is heard: a sound is asked for by the
number of its comparison and its side, and comes without a name, at the gain that all have.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from threading import Lock
from typing import Any

import numpy as np
from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import BaseRoute, Route

from models.errors import BushingNoiseError, ParameterError
from models.recording import REFERENCE_PRESSURE, Recording
from noise.app.gate import body
from noise.app.jury import VOTES, Jury, Votes, in_words, scale
from noise.app.opened import Opened
from noise.app.requests import choice, number, text
from noise.app.sounds import SoundCache
from noise.audio.render import Measured, full_scales, measure
from noise.audio.sound import RATE, audible, refuse_mixed
from noise.recordings.wav import wav_bytes

MOST = 40
"""Maximum number of sounds."""

LONGEST = 30.0
"""Maximum duration of a sound, from the start of the recording [s]."""

ONE_GAIN = "one gain"
"""Playback, as the table of votes states it."""

_LONGEST_TEXT = 200
_LONGEST_WAIT = 1e6
"""Maximum time between comparison and vote [s]."""


def routes(opened: Opened) -> list[BaseRoute]:
    """Return the routes of this view."""
    votes = Votes(opened.votes)
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

    def jury_of(request: Request) -> Jury:
        jury = votes.jury(request.path_params["jury"])
        if jury.played != ONE_GAIN:
            raise ParameterError(f"jury {jury.number}: was played at {jury.played}; begin another")
        return jury

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
        pairs = len(chosen) * (len(chosen) - 1) // 2
        comparisons = number(setup, "comparisons", len(chosen) - 1, pairs, pairs, whole=True)
        names = [opened.job(index).name for index in chosen]
        playing.gain(indices(names))  # or nobody could begin
        jury = votes.begin(
            names, listener=listener, question=question, played=ONE_GAIN, seed=opened.seed,
            comparisons=int(comparisons),
        )  # fmt: skip
        return JSONResponse(state(jury))

    def gone_on(request: Request) -> Response:
        jury = jury_of(request)
        gain = playing.gain(indices(jury.sounds))
        return JSONResponse(state(jury) | {"gain": gain})

    def audio(request: Request) -> Response:
        jury, place = jury_of(request), request.path_params["place"]
        side = {"a": 0, "b": 1}.get(request.path_params["side"])
        if side is None or place >= len(jury.pairs):
            raise ParameterError("there is no such sound")
        (index,) = indices([jury.pairs[place][side]])
        sound = playing.wav(index, indices(jury.sounds))
        return Response(sound, media_type="audio/wav")

    def voted(request: Request, vote: dict[str, Any]) -> Response:
        seconds = number(vote, "seconds", 0.0, _LONGEST_WAIT)
        place = int(number(vote, "place", 0, 1 << 31, whole=True))
        jury = request.path_params["jury"]
        return JSONResponse(state(votes.vote(jury, place, choice(vote, "vote", VOTES), seconds)))

    def result(request: Request) -> Response:
        jury = jury_of(request)
        rows = scale(jury)
        answer = {"sounds": rows, "words": in_words(rows), "voted": len(jury.votes)}
        return JSONResponse(state(jury) | answer)

    one = "/api/juries/{jury:int}"
    return [
        Route("/api/juries", juries, methods=["GET"]),
        Route("/api/juries", body(begun), methods=["POST"]),
        Route(one, gone_on),
        Route(f"{one}/heard/{{place:int}}/{{side}}", audio),
        Route(f"{one}/vote", body(voted), methods=["POST"]),
        Route(f"{one}/result", result),
    ]


class JuryPlaying:
    """Sounds of juries at one gain, safe for several threads.

    Parameters
    ----------
    opened : Opened
    sounds : SoundCache
    """

    def __init__(self, opened: Opened, sounds: SoundCache) -> None:
        self._opened = opened
        self._sounds = sounds
        self._lock = Lock()
        self._measured: dict[int, Measured] = {}

    def gain(self, indices: Sequence[int]) -> str:
        """Return the gain of playback in words.

        Raises
        ------
        BushingNoiseError
            The sounds cannot be played at one gain.
        """
        full_scale = self._full_scale(indices)
        if not self._sounds.track(indices[0]).calibrated:
            return f"one gain: full scale = {full_scale:.3g} of that of the files"
        level = 20.0 * math.log10(full_scale / REFERENCE_PRESSURE)
        return f"one gain: full scale = {full_scale:.4g} Pa ({level:.0f} dB peak re 20 µPa)"

    def wav(self, index: int, indices: Sequence[int]) -> bytes:
        """Return one of several sounds as a WAV file of floats.

        Raises
        ------
        BushingNoiseError
            The sounds cannot be played at one gain.
        """
        sound = audible(self._sound_of(index))
        return wav_bytes(sound / self._full_scale(indices), RATE, 32)

    def _full_scale(self, indices: Sequence[int]) -> float:
        with self._lock:
            for index in indices:
                if index not in self._measured:
                    self._measured[index] = measure([self._sound_of(index)])
        measured = {str(index): self._measured[index] for index in indices}
        refuse_mixed({of.calibrated: of.name for of in measured.values()}, "leave one of them out")
        return full_scales(measured)[str(indices[0])].value

    def _sound_of(self, index: int) -> Recording:
        name = self._opened.job(index).name
        try:
            track = self._sounds.track(index)
        except BushingNoiseError as error:
            raise ParameterError(f"{name}: cannot be heard ({error})") from None
        if track.channel.kind != "pressure":
            raise ParameterError(f"{name}: has no sound pressure to be heard; leave it out")
        samples = track.read(0, min(track.n, round(LONGEST * track.rate)))[np.newaxis]
        return Recording(
            samples, track.rate, (track.channel,), calibrated=track.calibrated, name=name
        )

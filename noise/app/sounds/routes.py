"""Routes: samples, spectrogram and levels of a recording."""

from __future__ import annotations

import json
from threading import Lock
from typing import TYPE_CHECKING

from starlette.responses import JSONResponse, Response
from starlette.routing import Route

from noise.app.sounds.playback import bands, equal, level_course, wav
from noise.app.sounds.sound_cache import SoundCache
from noise.app.sounds.spectrogram import line, outline, spectrogram

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    import numpy as np
    from numpy.typing import NDArray
    from starlette.requests import Request
    from starlette.routing import BaseRoute

    from noise.app.opened import Opened
    from noise.app.sounds.sound_cache import Track

    Query = Mapping[str, str]
    Facts = dict[str, object]

__all__ = ["routes"]


def routes(opened: Opened) -> list[BaseRoute]:
    """Return the routes that tell of recordings, each by its number."""
    sounds = SoundCache(opened)

    def about(request: Request) -> Response:
        from noise.labels.labelling import labelled_tracks  # which the list comes before

        index = request.path_params["id"]
        blocks = sounds.blocks(index)
        tracks = [sounds.track(index, channel.name) for channel in blocks.channels]
        channels = [
            {
                "name": track.channel.name,
                "kind": track.channel.kind,
                "unit": track.unit,
                "level_unit": track.level_unit,
            }
            for track in tracks
        ]
        heard = sounds.track(index)
        return JSONResponse(
            {
                "id": index,
                "name": opened.job(index).name,
                "channels": channels,
                "tracks": labelled_tracks(opened.job(index).path, len(channels)),
                "channel": heard.channel.name,
                "rate": blocks.rate,
                "duration_s": heard.duration,
                "calibrated": blocks.calibrated,
                "conditions": blocks.condition.words,
            }
        )

    def of_track(answer: Callable[[Track, Query], Response]) -> Callable[[Request], Response]:
        def endpoint(request: Request) -> Response:
            query = request.query_params
            return answer(sounds.track(request.path_params["id"], query.get("channel", "")), query)

        return endpoint

    def told(answer: Callable[[Track, Query], Facts]) -> Callable[[Request], Response]:
        return of_track(lambda track, query: JSONResponse(answer(track, query)))

    one_at_a_time = Lock()  # or what is seen of the next recording waits for them all

    def measured(answer: Callable[[Track, Query], Facts]) -> Callable[[Request], Response]:
        def in_turn(track: Track, query: Query) -> Facts:
            with one_at_a_time:
                return answer(track, query)

        return told(in_turn)

    def numbers(
        answer: Callable[[Track, Query], tuple[Facts, NDArray[np.generic]]],
    ) -> Callable[[Request], Response]:
        return of_track(lambda track, query: _framed(*answer(track, query)))

    at = "/api/sounds/{id:int}"
    return [
        Route(at, about),
        Route(f"{at}/audio", of_track(lambda *of: Response(wav(*of), media_type="audio/wav"))),
        Route(f"{at}/outline", numbers(outline)),
        Route(f"{at}/spectrogram", numbers(spectrogram)),
        Route(f"{at}/line", told(line)),
        Route(f"{at}/levels", measured(lambda track, _: level_course(track))),
        Route(f"{at}/bands", measured(bands)),
        Route(f"{at}/loudness", measured(equal)),
    ]


def _framed(facts: Facts, values: NDArray[np.generic]) -> Response:
    """Return numbers after what they mean: JSON of whole words, whose length stands before it."""
    said = json.dumps(facts).encode()
    said += b" " * (-len(said) % 4)
    content = len(said).to_bytes(4, "little") + said + values.tobytes()
    return Response(content, media_type="application/octet-stream")

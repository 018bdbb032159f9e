"""Routes: sounds compared blind.

While votes are given, nothing that is answered tells what is heard: a sound is asked for by the
number of its comparison and its side, and comes without a name.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from starlette.responses import JSONResponse, Response
from starlette.routing import Route

from models.errors import ParameterError
from noise.app.jury.order import ordered_pairs
from noise.app.jury.playing import LONGEST, Playing
from noise.app.jury.result import result, result_csv
from noise.app.jury.setup import MOST, read_design, read_setup, read_sounds
from noise.app.jury.store import Votes
from noise.app.jury.votes import VOTES
from noise.app.requests import body
from noise.app.sounds.sound_cache import SoundCache

if TYPE_CHECKING:
    from collections.abc import Sequence

    from starlette.requests import Request
    from starlette.routing import BaseRoute

    from noise.app.jury.order import Pair
    from noise.app.jury.store import Jury
    from noise.app.opened import Opened

__all__ = ["routes"]

_TABLE = "votes.csv"

_A_WHILE = 0.5
"""For which one request measures sounds [s]."""

_LONGEST_WAIT = 1e6
"""Between a comparison and its vote [s]; more is not told."""


def routes(opened: Opened) -> list[BaseRoute]:
    """Return the routes of this view."""
    folder = opened.folder if opened.table is None else opened.table.absolute().parent
    votes = Votes(folder / _TABLE)
    playing = Playing(opened, SoundCache(opened))
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
            "jury": jury.number,
            "listener": jury.listener,
            "question": jury.question,
            "played": jury.played,
            "sounds": len(jury.sounds),
            "total": len(jury.pairs),
            "waiting": jury.waiting,
            "last": {"place": len(jury.votes) - 1, "time": jury.last_time} if jury.votes else None,
            "open": all(len(by_name.get(name, ())) == 1 for name in jury.sounds),
        }

    def asked(request: Request) -> Jury:
        return votes.jury(request.path_params["jury"])

    def juries(_: Request) -> Response:
        return JSONResponse(
            {
                "juries": [state(jury) for jury in votes.juries()],
                "most": MOST,
                "longest_s": LONGEST,
                "table": votes.path.name,
            }
        )

    def planned(request: Request) -> Response:
        design = read_design(request.query_params)
        return JSONResponse({"pairs": design.pairs, "again": design.again})

    def prepared(chosen: Sequence[int]) -> Response:
        done = playing.prepare(chosen, _A_WHILE)
        return JSONResponse({"done": done, "total": len(chosen)})

    def prepared_new(_: Request, said: object) -> Response:
        return prepared(read_sounds(said))

    def prepared_again(request: Request, _: object) -> Response:
        return prepared(indices(asked(request).sounds))

    def begun(_: Request, said: object) -> Response:
        setup = read_setup(said)
        names = [opened.job(index).name for index in setup.sounds]
        indices(names)
        playing.gain(setup.sounds, setup.played)  # or nobody could begin

        def drawn(number: int) -> list[Pair]:
            return ordered_pairs(setup.design, np.random.default_rng([opened.seed, number]))

        jury = votes.begin(
            names,
            drawn,
            listener=setup.listener,
            question=setup.question,
            played=setup.played,
            seed=opened.seed,
        )
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

    def voted(request: Request, said: object) -> Response:
        vote = said if isinstance(said, dict) else {}
        place, what, seconds = (vote.get(key) for key in ("place", "vote", "seconds"))
        if type(place) is not int or what not in VOTES:
            raise ParameterError(f"a vote says place and vote, one of {', '.join(VOTES)}")
        if not isinstance(seconds, int | float) or not 0.0 <= seconds <= _LONGEST_WAIT:
            raise ParameterError("seconds: must be how long was listened")
        number = request.path_params["jury"]
        return JSONResponse(state(votes.vote(number, place, what, float(seconds))))

    def undone(request: Request, said: object) -> Response:
        vote = said if isinstance(said, dict) else {}
        place, time = vote.get("place"), vote.get("time")
        if type(place) is not int or not isinstance(time, str):
            raise ParameterError("an undo says place and time of the vote that it takes back")
        return JSONResponse(state(votes.undo(request.path_params["jury"], place, time)))

    def told(request: Request) -> Response:
        return JSONResponse(result(asked(request)))

    def table(request: Request) -> Response:
        jury = asked(request)
        name = f"jury-{jury.number}.csv"
        headers = {"Content-Disposition": f'attachment; filename="{name}"'}
        return Response(result_csv(jury), media_type="text/csv", headers=headers)

    one = "/api/juries/{jury:int}"
    return [
        Route("/api/juries", juries, methods=["GET"]),
        Route("/api/juries", body(begun), methods=["POST"]),
        Route("/api/juries/plan", planned),
        Route("/api/juries/prepare", body(prepared_new), methods=["POST"]),
        Route(one, gone_on),
        Route(f"{one}/prepare", body(prepared_again), methods=["POST"]),
        Route(f"{one}/heard/{{place:int}}/{{side}}", heard),
        Route(f"{one}/vote", body(voted), methods=["POST"]),
        Route(f"{one}/undo", body(undone), methods=["POST"]),
        Route(f"{one}/result", told),
        Route(f"{one}/result.csv", table),
    ]

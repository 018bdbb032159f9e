"""Routes: recordings as a list, their labels, corrections."""

from __future__ import annotations

from typing import TYPE_CHECKING

from starlette.responses import JSONResponse
from starlette.routing import Route

from models.errors import ParameterError
from noise.app.labels.corrections import read_corrections
from noise.app.labels.labelling_run import LabellingRun
from noise.app.labels.list_query import read_list_query, whole_number
from noise.app.labels.next_check import NextCheck
from noise.app.labels.segment_features import SegmentFeatures
from noise.app.labels.store import Labels
from noise.app.labels.summary import conditions, plain
from noise.app.labels.training_run import TrainingRun, own_classifier
from noise.app.requests import body
from noise.labels.labelling import Labelling
from noise.labels.row_places import version

if TYPE_CHECKING:
    from starlette.requests import Request
    from starlette.responses import Response
    from starlette.routing import BaseRoute

    from noise.app.opened import Opened

__all__ = ["routes"]

_LONGEST_NAME = 80
"""Characters by which pages are told from each other."""


def routes(opened: Opened) -> list[BaseRoute]:
    """Return the routes of this view."""
    if opened.table is None:
        return [Route("/api/recordings", _nothing)]
    learned = own_classifier(opened.table)
    classifier = learned if learned.is_file() else None
    labels = Labels(opened.jobs, opened.table, Labelling(classifier))
    run = LabellingRun(labels, opened, classifier)
    opened.leaving.callback(run.stop)
    describing = SegmentFeatures()
    opened.leaving.callback(describing.stop)
    check = NextCheck(opened.jobs, describing)
    training = TrainingRun(labels, run, opened)
    opened.leaving.callback(training.stop)

    def recordings(request: Request) -> Response:
        shown = labels.summaries()
        done = sum(bool(one["labels"] or one["error"]) for one in shown)
        answer = read_list_query(request.query_params).answer(shown)
        seen = _recording(request, "open")
        if seen is not None:
            answer["open"] = {"id": seen, "version": version(labels.rows(seen))}
        return JSONResponse({**answer, "state": run.state(done)})

    def segments(request: Request) -> Response:
        job = opened.job(request.path_params["id"])
        return JSONResponse(_segments(job.index, labels.rows(job.index)))

    def corrected(request: Request, said: object) -> Response:
        job = opened.job(request.path_params["id"])
        said = said if isinstance(said, dict) else {}
        corrections = read_corrections(said.get("rows"))
        if not isinstance(of := said.get("version"), str):
            raise ParameterError("version: must be that of the segments which are corrected")
        return JSONResponse(
            _segments(job.index, labels.correct(job.index, corrections, of, _page(said)))
        )

    def undone(_: Request, said: object) -> Response:
        index, rows = labels.undo(_page(said))
        return JSONResponse(_segments(index, rows))

    def labelled(_: Request, __: object) -> Response:
        run.start()
        return JSONResponse(run.state(0))

    def following(request: Request) -> Response:
        return JSONResponse(check.next(labels.all_rows(), _recording(request, "after")))

    def trained(_: Request, __: object) -> Response:
        training.start()
        return JSONResponse(training.state())

    def learning(_: Request) -> Response:
        return JSONResponse(training.state())

    def _recording(request: Request, key: str) -> int | None:
        query = request.query_params
        return whole_number(query, key, 0, len(opened.jobs) - 1) if query.get(key) else None

    def _segments(index: int, rows: list[dict[str, object]]) -> dict[str, object]:
        return {
            "id": index,
            "name": opened.jobs[index].name,
            "version": version(rows),
            "rows": [
                shown | {"conditions": conditions(row)}
                for row, shown in zip(rows, plain(rows), strict=True)
            ],
        }

    return [
        Route("/api/recordings", recordings),
        Route("/api/recordings/{id:int}/segments", segments, methods=["GET"]),
        Route("/api/recordings/{id:int}/segments", body(corrected), methods=["POST"]),
        Route("/api/undo", body(undone), methods=["POST"]),
        Route("/api/next", following),
        Route("/api/train", learning, methods=["GET"]),
        Route("/api/train", body(trained), methods=["POST"]),
        Route("/api/label", body(labelled), methods=["POST"]),
    ]


def _page(said: object) -> str:
    """Return the page that a request comes from, as it calls itself."""
    return str(said.get("page", ""))[:_LONGEST_NAME] if isinstance(said, dict) else ""


def _nothing(request: Request) -> Response:
    state = {"done": 0, "total": 0, "running": False, "message": "", "classifier": None}
    return JSONResponse({**read_list_query(request.query_params).answer([]), "state": state})

"""Routes of the view of recordings: list, labels, corrections, labelling, learning."""

from __future__ import annotations

import json
import math
from collections import Counter
from collections.abc import Mapping, Sequence
from hashlib import blake2b
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from platformdirs import user_cache_path
from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import BaseRoute, Route

from models.errors import ParameterError
from noise.app.commands import Command
from noise.app.gate import body
from noise.app.labels import Labels, read_corrections
from noise.app.opened import Opened
from noise.app.requests import choice, number
from noise.base.labels import LABELS
from noise.base.tables import plain_cell, write_table
from noise.labels.corrections import version
from noise.labels.labelling import Labelling
from noise.labels.table import COLUMNS, HUMAN

Row = dict[str, object]

_ORDERS = {
    "name": "name",
    "label": "label",
    "frequency": "frequency_hz",
    "level": "level_dba",
    "duration": "duration_s",
    "least_sure": "least_sure",
}
"""Columns that a list is sorted by, as requests call them."""

UNLABELLED, PARTLY, CORRECTED, REFUSED = "unlabelled", "partly", "corrected", "refused"
"""What a list is filtered by beside the labels."""

_LONGEST_NAME = 80
"""Characters by which pages are told from each other."""

_CONDITIONS = ("speed", "interference", "stiffness", "material")


def routes(opened: Opened) -> list[BaseRoute]:
    """Return the routes of this view."""
    if opened.table is None:
        return [Route("/api/recordings", _nothing)]
    run = LabellingRun(opened, opened.table)
    labels = run.labels
    opened.leaving.callback(run.stop)

    def recordings(request: Request) -> Response:
        query, shown = request.query_params, labels.summaries()
        answer = list_answer(query, shown)
        known = blake2b(json.dumps(answer["rows"]).encode(), digest_size=8).hexdigest()
        if query.get("known") == known:  # nothing has changed, so that nothing is sent again
            answer["rows"] = None
        answer["known"] = known
        if query.get("open"):
            seen = int(number(query, "open", 0, len(opened.jobs) - 1, whole=True))
            answer["open"] = {"id": seen, "version": version(labels.rows(seen))}
        done = sum(bool(one["labels"] or one["error"]) for one in shown)
        return JSONResponse({**answer, "state": {"done": done, **run.state()}})

    def segments(request: Request) -> Response:
        job = opened.job(request.path_params["id"])
        return JSONResponse(_segments(job.index, labels.rows(job.index)))

    def corrected(request: Request, content: dict[str, Any]) -> Response:
        job = opened.job(request.path_params["id"])
        corrections = read_corrections(content.get("rows"))
        if not isinstance(of := content.get("version"), str):
            raise ParameterError("version: must be that of the segments which are corrected")
        rows = labels.correct(job.index, corrections, of, _page(content))
        return JSONResponse(_segments(job.index, rows))

    def undone(_: Request, content: dict[str, Any]) -> Response:
        return JSONResponse(
            _segments(*labels.undo(_page(content), redo=content.get("redo") is True))
        )

    def labelled(_: Request, __: dict[str, Any]) -> Response:
        run.start()
        return JSONResponse(run.state())

    def learned(_: Request, __: dict[str, Any]) -> Response:
        run.learn()
        return JSONResponse(run.state())

    def _segments(index: int, rows: Sequence[Row]) -> dict[str, object]:
        return {
            "id": index,
            "name": opened.jobs[index].name,
            "version": version(rows),
            "rows": [
                {name: _plain(name, value) for name, value in row.items()}
                | {"row": number, "conditions": conditions(row)}
                for number, row in enumerate(rows)
            ],
        }

    return [
        Route("/api/recordings", recordings),
        Route("/api/recordings/{id:int}/segments", segments, methods=["GET"]),
        Route("/api/recordings/{id:int}/segments", body(corrected), methods=["POST"]),
        Route("/api/undo", body(undone), methods=["POST"]),
        Route("/api/train", body(learned), methods=["POST"]),
        Route("/api/label", body(labelled), methods=["POST"]),
    ]


class LabellingRun:
    """``bushing-noise label`` on all recordings, and ``train --add`` on what was corrected.

    A classifier that was trained stands beside the table, and labels whatever is opened there.

    Parameters
    ----------
    opened : Opened
    table : Path
        Of labels.
    """

    def __init__(self, opened: Opened, table: Path) -> None:
        self._opened = opened
        self._own = table.with_name(f"{table.stem}.classifier.npz")
        self.labels = Labels(opened.jobs, table, Labelling(self._classifier))
        self._labelling = Command(lambda _: self.labels.ended())
        self._learning = Command(self._learned)

    @property
    def _classifier(self) -> Path | None:
        return self._own if self._own.is_file() else None

    def start(self) -> None:
        """Label, or go on; nothing happens while it runs."""
        if self._labelling.running:
            return
        classifier = self._classifier
        self.labels.follow(Labelling(classifier))
        chosen = [] if classifier is None else ["--classifier", str(classifier)]
        paths = [str(path.absolute()) for path in self._opened.sources]
        self._labelling.start(["label", "--out", str(self.labels.path), *chosen, "--", *paths])

    def learn(self) -> None:
        """Train with the corrections, then label all else anew; nothing happens while it runs.

        Raises
        ------
        ParameterError
            Nothing is corrected yet.
        """
        rows = [
            row | {"file": str(job.path.absolute())}
            for job in self._opened.jobs
            for row in self.labels.rows(job.index)
            if row.get("label_source") == HUMAN
        ]
        if not rows:
            raise ParameterError("nothing is corrected yet, so there is nothing to learn from")
        if self._learning.running:
            return
        folder = self._opened.leaving.enter_context(TemporaryDirectory(prefix="bushing-noise-"))
        table = Path(folder) / "corrections.csv"
        write_table(table, COLUMNS, rows)
        samples = [] if self._opened.samples is None else ["--samples", str(self._opened.samples)]
        simulated = user_cache_path("bushing-noise") / f"samples{'-'.join(('', *samples[1:]))}.npz"
        files = ["--add", str(table), "--out", str(self._own), "--keep", str(simulated)]
        self._learning.start(["train", *files, *samples])

    def stop(self) -> None:
        """End both; what is labelled is kept."""
        self._learning.stop()
        self._labelling.stop()

    def state(self) -> dict[str, object]:
        """Return how many recordings there are [-], what runs, and what it said last."""
        running = [one for one in (self._learning, self._labelling) if one.running]
        failed = [
            one.message for one in (self._learning, self._labelling) if one.code not in (None, 0, 1)
        ]
        return {
            "total": len(self._opened.jobs),
            "running": bool(running),
            "learning": self._learning.running,
            "classifier": self._classifier.name if self._classifier else None,
            "message": running[0].message if running else "; ".join(failed),
        }

    def _learned(self, code: int) -> None:
        if code in (0, 1):  # 1: some of what was corrected could not be learned from
            self._labelling.stop()
            self.start()


def list_answer(query: Mapping[str, str], shown: Sequence[Row]) -> dict[str, object]:
    """Return the recordings that a list asks for, how many there are, and how many by label.

    Parameters
    ----------
    query : mapping of str to str
        `label` in some segment, or ``unlabelled``, ``partly``, ``corrected``, ``refused``; `text`
        that the name holds, whatever its case; column to `sort` by, in the `order` ``asc`` or
        ``desc``.
    shown : sequence of dict
        As of `summary`.

    Raises
    ------
    ParameterError
        It is not understood.

    Examples
    --------
    >>> from noise.app.labels import summary
    >>> row = {"label": "squeal", "start_s": 0.0, "end_s": 2.0}
    >>> found = list_answer({"label": "squeal", "sort": "level"}, [summary(7, "run07.wav", [row])])
    >>> found["counts"]["squeal"], found["rows"][0]["name"]
    (1, 'run07.wav')
    """
    kinds = (*LABELS, UNLABELLED, PARTLY, CORRECTED, REFUSED)
    label, sort = choice(query, "label", kinds), choice(query, "sort", _ORDERS)
    order = choice(query, "order", ("asc", "desc"), "asc")
    text = query.get("text", "").casefold()
    named = [one for one in shown if text in str(one["name"]).casefold()]
    counts = Counter(kind for one in named for kind in _kinds(one))
    found = [one for one in named if not label or label in _kinds(one)]
    if sort:
        found = _sorted(found, _ORDERS[sort], descending=order == "desc")
    return {
        "counts": {"": len(named), **{kind: counts[kind] for kind in kinds}},
        "rows": found,
    }


def conditions(row: Row) -> list[str]:
    """Return the operating conditions of a segment in words, as pages have them.

    Examples
    --------
    >>> row = {"label": "creak", "interference_mm": 0.279}
    >>> speed = {"speed_rad_s": 5.2, "speed_rad_s_low": 3.1, "speed_rad_s_high": 8.0}
    >>> conditions({**row, **speed, "speed_rad_s_source": "inferred"})
    ['speed 3.1 to 8 rad/s (inferred)', 'interference 0.279 mm']
    """
    # The list is there before what only pages need is loaded.
    from noise.pages.cards import facts_of
    from noise.pages.clips import Entry

    facts = facts_of(Entry("", (row,)))
    if not row.get("material"):  # which one is assumed, the row's note says
        facts.pop("material", None)
    return [f"{name} {facts[name].words}" for name in _CONDITIONS if name in facts]


def _kinds(one: Row) -> list[str]:
    """Return what a recording is found under: each label in it."""
    labels = [str(label) for label in one["labels"]]  # type: ignore[attr-defined]
    kinds = labels + [REFUSED] * bool(one["error"])
    kinds += [CORRECTED] * bool(one["corrected"]) + [PARTLY] * bool(one["partly"])
    return kinds if labels or one["error"] else [*kinds, UNLABELLED]


def _sorted(shown: Sequence[Row], key: str, *, descending: bool) -> list[Row]:
    """Sort by a column; what has nothing there comes last either way."""
    there = [one for one in shown if one[key] is not None]
    rest = [one for one in shown if one[key] is None]

    def value(one: Row) -> Any:
        return one[key].casefold() if isinstance(one[key], str) else one[key]  # type: ignore[attr-defined]

    return [*sorted(there, key=value, reverse=descending), *rest]


def _plain(name: str, value: object) -> object:
    """Return a cell as JSON can hold it; the bolted clamp is the word ``fixed``."""
    if isinstance(value, float) and not math.isfinite(value):
        return "fixed" if name.startswith("support_stiffness") and value > 0.0 else None
    return plain_cell(value)  # a date of a column of one's own is text


def _page(content: dict[str, Any]) -> str:
    """Return the page that a request comes from, as it calls itself."""
    return str(content.get("page", ""))[:_LONGEST_NAME]


def _nothing(request: Request) -> Response:
    state = {"done": 0, "total": 0, "running": False, "message": "", "classifier": None}
    return JSONResponse({**list_answer(request.query_params, []), "state": state})

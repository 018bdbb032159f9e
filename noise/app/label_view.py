"""Routes of the view of recordings: list, labels, corrections, labelling."""

from __future__ import annotations

import json
import math
import os
import subprocess
import sys
from collections import Counter
from collections.abc import Mapping, Sequence
from contextlib import suppress
from hashlib import blake2b
from threading import Thread
from typing import Any

from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import BaseRoute, Route

from models.errors import ParameterError
from noise.app.corrected_segments import Row, read_corrections
from noise.app.gate import body
from noise.app.labels import Labels
from noise.app.opened import Opened
from noise.app.requests import choice, number
from noise.base.labels import LABELS, SURROUNDINGS
from noise.base.progress import LINES, say
from noise.base.tables import plain_cell
from noise.labels.corrections import version

_ORDERS = {
    "name": "name",
    "label": "label",
    "frequency": "frequency_hz",
    "level": "level_dba",
    "duration": "duration_s",
    "least_sure": "least_sure",
}
"""Sort columns by their names in requests."""

UNLABELLED, PARTLY, CORRECTED, REFUSED = "unlabelled", "partly", "corrected", "refused"
"""Filters besides the labels."""

_NICE = 10
"""Niceness of the labelling process."""

_PATIENCE = 10.0
"""Time for a command to write its results after termination [s]."""

_CONDITIONS = ("speed", "interference", "stiffness", "material")


def routes(opened: Opened) -> list[BaseRoute]:
    """Return the routes of this view."""
    if opened.table is None:
        return [Route("/api/recordings", _nothing)]
    labels = Labels(opened.jobs, opened.table)
    if (file := labels.foreign_file()) is not None:
        say(
            f"note: {opened.table} names none of these recordings ({file}, ...); to see its "
            "labels, open the folder that its files are relative to together with the table"
        )
    labelling = Command()
    opened.leaving.callback(labelling.stop)

    def state() -> dict[str, object]:
        """Return number of recordings [-], whether labelling runs, and its message."""
        return {
            "total": len(opened.jobs), "running": labelling.running, "message": labelling.message,
        }  # fmt: skip

    def recordings(request: Request) -> Response:
        query, shown = request.query_params, labels.summaries()
        answer = list_answer(query, shown)
        known = blake2b(json.dumps(answer["rows"]).encode(), digest_size=8).hexdigest()
        if query.get("known") == known:  # nothing has changed, so that nothing is sent again
            answer["rows"] = None
        answer["known"] = known
        if query.get("open"):
            number_open = int(number(query, "open", 0, len(opened.jobs) - 1, whole=True))
            answer["open"] = {"id": number_open, "version": version(labels.rows(number_open))}
        done = sum(bool(one["labels"] or one["error"]) for one in shown)
        return JSONResponse({**answer, "state": {"done": done, **state()}})

    def segments(request: Request) -> Response:
        job = opened.job(request.path_params["id"])
        return JSONResponse(_segments(job.index, labels.rows(job.index)))

    def corrected(request: Request, content: dict[str, Any]) -> Response:
        job = opened.job(request.path_params["id"])
        corrections = read_corrections(content.get("rows"))
        if not isinstance(of := content.get("version"), str):
            raise ParameterError("version: must be that of the segments which are corrected")
        return JSONResponse(_segments(job.index, labels.correct(job.index, corrections, of)))

    def undone(_: Request, content: dict[str, Any]) -> Response:
        return JSONResponse(_segments(*labels.undo(redo=content.get("redo") is True)))

    def labelled(_: Request, content: dict[str, Any]) -> Response:
        place = choice(content, "surroundings", SURROUNDINGS)
        if not labelling.running:
            paths = [str(path.absolute()) for path in opened.sources]
            where = ["--surroundings", place] if place else []
            labelling.start(["label", *where, "--out", str(labels.path), "--", *paths])
        return JSONResponse(state())

    def _segments(index: int, rows: Sequence[Row]) -> dict[str, object]:
        return {
            "id": index,
            "name": opened.jobs[index].name,
            "version": version(rows),
            "history": labels.history,
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
        Route("/api/label", body(labelled), methods=["POST"]),
    ]


class Command:
    """Runner of one command of the program at a time, in a subprocess."""

    def __init__(self) -> None:
        self._process: subprocess.Popen[str] | None = None
        self.message = ""

    @property
    def running(self) -> bool:
        """Whether the command is running."""
        return self._process is not None and self._process.poll() is None

    def start(self, arguments: Sequence[str]) -> None:
        """Start the command; `message` is its last line, empty after its success."""
        self.message = ""
        self._process = subprocess.Popen(
            [sys.executable, "-m", "noise", *arguments],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
            encoding="utf-8",
            errors="replace",
            env={**os.environ, LINES: "1"},
        )
        with suppress(OSError, AttributeError):  # it has ended already; this is Windows
            os.setpriority(os.PRIO_PROCESS, self._process.pid, _NICE)
        Thread(target=self._watch, args=(self._process,), daemon=True).start()

    def _watch(self, process: subprocess.Popen[str]) -> None:
        assert process.stderr is not None
        with process.stderr as lines:
            for line in lines:
                self.message = line.strip()
        if process.wait() in (0, 1):
            self.message = ""

    def stop(self) -> None:
        """Terminate the command and wait for its end."""
        if self._process is not None:
            self._process.terminate()
            try:
                self._process.wait(_PATIENCE)
            except subprocess.TimeoutExpired:
                self._process.kill()


def list_answer(query: Mapping[str, str], shown: Sequence[Row]) -> dict[str, object]:
    """Return the recordings of a list request, and counts by label.

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
        A parameter is invalid.

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
    matching = [one for one in named if not label or label in _kinds(one)]
    if sort:
        matching = _sorted(matching, _ORDERS[sort], descending=order == "desc")
    return {
        "counts": {"": len(named), **{kind: counts[kind] for kind in kinds}},
        "rows": matching,
    }


def conditions(row: Row) -> list[str]:
    """Return the operating conditions of a segment in words.

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
    return [f"{name} {facts[name]}" for name in _CONDITIONS if name in facts]


def _kinds(one: Row) -> list[str]:
    """Return the filters that match a recording."""
    labels = [str(label) for label in one["labels"]]  # type: ignore[attr-defined]
    kinds = labels + [REFUSED] * bool(one["error"])
    kinds += [CORRECTED] * bool(one["corrected"]) + [PARTLY] * bool(one["partly"])
    return kinds if labels or one["error"] else [*kinds, UNLABELLED]


def _sorted(shown: Sequence[Row], key: str, *, descending: bool) -> list[Row]:
    """Sort by a column, empty values last."""
    there = [one for one in shown if one[key] is not None]
    rest = [one for one in shown if one[key] is None]

    def value(one: Row) -> Any:
        return one[key].casefold() if isinstance(one[key], str) else one[key]  # type: ignore[attr-defined]

    return [*sorted(there, key=value, reverse=descending), *rest]


def _plain(name: str, value: object) -> object:
    """Return a cell as a JSON value; the bolted clamp is ``fixed``."""
    if isinstance(value, float) and not math.isfinite(value):
        return "fixed" if name.startswith("support_stiffness") and value > 0.0 else None
    return plain_cell(value)  # a date of a column of one's own is text


def _nothing(request: Request) -> Response:
    state = {"done": 0, "total": 0, "running": False, "message": ""}
    return JSONResponse({**list_answer(request.query_params, []), "state": state})

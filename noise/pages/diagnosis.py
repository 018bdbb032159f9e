"""The report of a diagnosis: one page to be understood in a minute, and its data beside it.

Order is rank: what is missing and how sure that is, where it acts, how far it closes the gap, what
to measure next; then the evidence for eye and ear; figures for whoever doubts come last.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from models.transfer_functions.files import write_transfer_function
from noise.base.files import atomic
from noise.diagnosis.findings import ROLES, LabelsAndLevels
from noise.diagnosis.gap.signature import KINDS
from noise.diagnosis.improved_file import NAME, RESPONSES, response_files
from noise.diagnosis.outcome import Diagnosis
from noise.diagnosis.outcome_json import as_json
from noise.diagnosis.text.agreement_sentences import agreement_sentence
from noise.diagnosis.text.improved_sentences import improved_sentence
from noise.diagnosis.text.sentences import answer
from noise.diagnosis.text.verdict_sentences import headline
from noise.diagnosis.text.words import NOT_DETERMINED, cause_of, joined, number, p_number
from noise.pages.clips import Clip, Entry
from noise.pages.diagnosis_answer import (
    agreement_rows,
    cause_rows,
    hypothesis_rows,
    parameter_rows,
    place_rows,
    stage_boxes,
    waterfall,
)
from noise.pages.page import page_html, write_page


def write_diagnosis(
    folder: Path, diagnosis: Diagnosis, improved: str | None = None, commands: Sequence[str] = ()
) -> None:
    """Write ``report.html``, ``diagnosis.json`` and ``improved.toml``, all whole or none at all.

    Parameters
    ----------
    folder : Path
        Made where it is not there; older files of these names are replaced, or taken away.
    diagnosis : Diagnosis
    improved : str, optional
        The rig file of the improved rig; without it none is left there.
    commands : sequence of str
        What to call next with it.

    Raises
    ------
    ParameterError
        A file cannot be written, or a signal cannot be analysed.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> from noise.diagnosis.outcome import Diagnosis
    >>> nothing = Diagnosis((), (), None, {}, (), {"none": 1.0}, {}, "", (), 0.9, 1.0, 0.6, 1.0)
    >>> with tempfile.TemporaryDirectory() as name:
    ...     write_diagnosis(Path(name), nothing)
    ...     sorted(path.name for path in Path(name).iterdir())
    ['diagnosis.json', 'report.html']
    """
    content = as_json(diagnosis, NAME if improved is not None else None)
    data = json.dumps(content, indent=2, ensure_ascii=False, allow_nan=False)
    found = diagnosis.improvement if improved is not None else None
    responses = {} if found is None else response_files(found)
    html = _html(diagnosis, commands if improved is not None else ())
    with atomic(folder / "diagnosis.json") as json_part, ExitStack() as files:
        # Names of files may hold what no UTF-8 can.
        json_part.write_bytes(f"{data}\n".encode("utf-8", "backslashreplace"))
        if improved is not None:
            rig_part = files.enter_context(atomic(folder / NAME))
            rig_part.write_bytes(improved.encode("utf-8", "backslashreplace"))
        for name, transfer in responses.items():
            write_transfer_function(files.enter_context(atomic(folder / name)), transfer)
        write_page(folder / "report.html", html)
        if improved is None:
            (folder / NAME).unlink(missing_ok=True)
        for older in folder.glob(f"{RESPONSES}torque_to_*.npz"):
            if older.name not in responses:
                older.unlink()


def _html(diagnosis: Diagnosis, commands: Sequence[str]) -> str:
    entries: dict[str, Entry] = {}
    clips: dict[str, Clip] = {}
    contents: dict[str, Any] = {"comparisons": (), "curves": {}, "gain": ()}
    if diagnosis.illustrations or diagnosis.labels_and_levels:
        # Figures and sounds load much that a quick answer, which has none, need not wait for.
        from noise.pages.diagnosis_evidence import draw_comparisons

        entries, clips, contents = draw_comparisons(diagnosis)
    likely, unlikely = cause_rows(diagnosis)
    agreement = "" if diagnosis.bench else agreement_sentence(diagnosis)
    return page_html(
        "diagnosis.html.j2",
        entries,
        clips,
        title=headline(diagnosis),
        agreement=agreement,
        answer=[sentence for sentence in answer(diagnosis) if sentence != agreement],
        stages=stage_boxes(diagnosis),
        waterfall=waterfall(diagnosis),
        likely=likely,
        unlikely=unlikely,
        next_measurement=diagnosis.next_measurement,
        improved=NAME if commands else "",
        improved_words=improved_sentence(diagnosis.improvement) if diagnosis.improvement else "",
        commands=commands,
        notes=diagnosis.notes,
        places=place_rows(diagnosis.differences),
        kinds=KINDS,
        agreements=agreement_rows(diagnosis.agreement),
        hypotheses=hypothesis_rows(diagnosis.hypotheses),
        parameters=parameter_rows(diagnosis.parameters),
        held_out=diagnosis.held_out,
        heard=[_heard_row(heard) for heard in diagnosis.labels_and_levels],
        gap=number(diagnosis.gap),
        floor=number(diagnosis.floor),
        p_value=p_number(diagnosis.p_value),
        seconds=number(diagnosis.seconds, ".1f"),
        not_determined=NOT_DETERMINED,
        judged=bool(diagnosis.verdict),
        bench=diagnosis.bench,
        fitted_words=_fitted_words(diagnosis),
        **contents,
    )


def _fitted_words(diagnosis: Diagnosis) -> str:
    """Say what the fitted model that is shown has; empty where none is."""
    if all(one.after is None for one in diagnosis.illustrations):
        return ""
    if diagnosis.improvement is not None:
        return "The fitted model is the improved rig."
    if diagnosis.verdict in {("parameters",), ("unknown",)}:
        return "The fitted model has refitted parameters and no effect."
    named = joined([cause_of(name).name for name in diagnosis.verdict])
    return f"The fitted model has {named} and refitted parameters."


def _heard_row(heard: LabelsAndLevels) -> list[str]:
    """Name of a recording, and for each role label and level in words."""
    row = [heard.recording]
    for role in ROLES:
        label, level = heard.of(role)
        known = "level not determined" if level is None else f"{number(level, '.1f')} dB(A)"
        row.append(f"{label or 'label not determined'}, {known}")
        if label is None and level is None:
            row[-1] = NOT_DETERMINED
    return row

"""``bushing-noise diagnose``: compare recordings with the simulator and name the missing effect."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from noise.base.progress import Steps, note, report, say, steps
from noise.commands.options import CHANGE, Option, changed, check_folder

if TYPE_CHECKING:
    from noise.diagnosis.case import Case
    from noise.diagnosis.outcome import Diagnosis
    from sim.effects.effect import Effect


_QUICK_STEPS, _STEPS = 5, 12
"""Steps of a diagnosis without fits, and with those of about five hypotheses."""


OPTIONS = (
    Option("data DATA", Path, count="+"),
    Option("--rig RIG.toml", Path, required=True),
    CHANGE,
    Option("--out FOLDER", Path),
    Option("--effects FILE.py", Path),
    Option("--quick"),
)


def run(options: Namespace) -> int:
    """Diagnose, write the results and print the answer."""
    check_folder(options.out, file="report.html")
    with steps("diagnosing", _QUICK_STEPS if options.quick else _STEPS) as progress:
        case, library, printed = _read(options, progress)
        from noise.diagnosis.diagnose import diagnose_case

        diagnosis = diagnose_case(
            case, quick=options.quick, library=library, seed=options.seed or 0, progress=progress
        )
        if options.out is not None:
            progress("writing the report")
            written = _write(options, diagnosis)
    if options.out is None:
        import json

        from noise.diagnosis.outcome import as_json

        print(json.dumps(as_json(diagnosis), indent=2))
    else:
        report(*written)
    _print_answer(options, diagnosis, printed)
    return 1 if case.refused else 0


def _read(options: Namespace, progress: Steps) -> tuple[Case, Mapping[str, Effect], set[str]]:
    """Read rig file, effects and recordings; return them with the printed notes."""
    progress("preparing")
    from models.rig_file import load_rig
    from noise.base.user_effects import effect_library
    from noise.diagnosis.improved_file import check_base

    rig = changed(load_rig(options.rig), options.change)
    if options.out is not None:
        check_base(options.rig, options.out)
    library = effect_library(options.effects)
    from noise.diagnosis.case import read_case  # slow import, after the options were checked
    from noise.diagnosis.diagnose import case_remarks

    case = read_case(options.data, rig)
    for name, reason in case.refused:
        say(f"{name}: {reason}")
    remarks = case_remarks(case, library)
    note(*remarks)
    left_out = {f"{name} was left out: {reason}" for name, reason in case.refused}
    return case, library, {*remarks, *left_out}


def _print_answer(options: Namespace, diagnosis: Diagnosis, printed: set[str]) -> None:
    """Print the answer, and its notes that have not been printed."""
    from noise.diagnosis.sentences import answer, finding_of, fit_sentence

    for sentence in answer(diagnosis):
        say(sentence)
    finding = finding_of(diagnosis, diagnosis.verdict[0]) if diagnosis.verdict else None
    if finding is not None and finding.closed is not None:
        say(fit_sentence(finding))
    if diagnosis.next_measurement and not diagnosis.bench:
        say(f"Measure next: {diagnosis.next_measurement}.")
    printed |= {*diagnosis.bench, *diagnosis.faults}  # sentences of the answer
    note(*(text for text in diagnosis.notes if text not in printed))
    if options.out is not None and diagnosis.improvement is not None:
        from noise.diagnosis.improved_file import improved_sentence

        say(
            "improved.toml is the simplest fit that closes the gap, in forms that a rig file can "
            f"state, compared with repeats of its own. {improved_sentence(diagnosis.improvement)}"
        )


def _write(options: Namespace, diagnosis: Diagnosis) -> list[Path]:
    """Write report, JSON and the improved rig file; return their paths."""
    from models.rig_file import base_name, material_of
    from noise.diagnosis.improved_file import NAME, improved_text
    from noise.pages.diagnosis import write_diagnosis

    improved, improvement = None, diagnosis.improvement
    if improvement is not None:
        base = material_of(options.rig) or base_name(options.rig, options.out)
        improved = improved_text(improvement, base, dict(options.change or ()))
    write_diagnosis(options.out, diagnosis, improved)
    names = ("report.html", "diagnosis.json", *([NAME] if improved is not None else []))
    return [options.out / name for name in names]

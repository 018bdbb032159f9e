"""Demonstration: the rig's three noises and a silent rubber, from physics to a page in one call.

The conditions are those of the thesis's Figures 5.21, 5.22 and 5.24, and PDMS for comparison.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from features.recording import recording_features
from features.table import recording_feature_names
from models.rig_file import load_material_rig
from noise.audio.audio_file import write_audio
from noise.audio.gain import QUIETEST_FULL_SCALE, common_full_scale
from noise.audio.sound import audible
from noise.base.files import locked
from noise.base.progress import say, track
from noise.base.tables import write_table
from noise.classifier import load_classifier
from noise.demo_hits import write_hits
from noise.labels.corrections import with_corrections
from noise.labels.rows import label_rows
from noise.labels.segments import file_label, label_recording
from noise.labels.table import LabelTable
from noise.pages.report import ReportEntry, write_report
from noise.recordings import read_recording, write_recording
from sim.run import simulate

if TYPE_CHECKING:
    from models.recording import Recording
    from noise.labels.segments import Segment

__all__ = ["CASES", "Case", "run_demo"]


@dataclass(frozen=True)
class Case:
    """One condition of the demonstration.

    Parameters
    ----------
    name : str
        Label that it has.
    material : str
    speed, interference, support_stiffness : float
        [rad/s], [m], [Nm/rad]
    source : str
        Where in the thesis it stands.
    """

    name: str
    material: str
    speed: float
    interference: float
    support_stiffness: float
    source: str


CASES = (
    Case("creak", "fluorocarbon", 1.0, 0.381e-3, 2214.0, "the condition of Figure 5.21"),
    Case("squawk", "fluorocarbon", 5.0, 0.279e-3, 2214.0, "the condition of Figure 5.22"),
    Case("squeal", "fluorocarbon", 10.0, 0.279e-3, 3745.0, "the condition of Figure 5.24"),
    Case("none", "PDMS", 5.0, 0.381e-3, 2214.0, "silent at every speed (Section 5.1.2)"),
)

_SECONDS = 2.0
"""Of each recording [s]."""

_RATE = 48_000
"""Of the sounds for listening [Hz]."""


def run_demo(out: Path, *, seed: int = 0) -> None:
    """Simulate, render, label and show the four cases.

    Parameters
    ----------
    out : Path
        Folder; gets ``recordings/``, ``audio/``, ``hits/``, ``features.csv``, ``labels.csv``
        and ``report.html``.
    seed : int
        Of the sensors' noise.

    Raises
    ------
    ParameterError
        The folder cannot be written.
    """
    out = Path(out)
    say("simulating four conditions of the rig (the first run compiles the solver)")
    *generators, hammer = np.random.default_rng(seed).spawn(len(CASES) + 1)
    for case, rng in track(list(zip(CASES, generators, strict=True)), "simulate"):
        run = simulate(
            load_material_rig(case.material),
            case.speed,
            interference=case.interference,
            support_stiffness=case.support_stiffness,
            seconds=_SECONDS,
            rng=rng,
        )
        write_recording(out / "recordings" / f"{case.name}.wav", run.recording)
    write_hits(out / "hits", hammer)

    say("labelling, rendering, drawing")
    classifier = load_classifier()
    feature_rows, rows, entries = [], [], []
    for case in track(CASES, "label"):
        file = f"{case.name}.wav"
        # What was written is what is looked at, as it would be with a measured recording.
        recording = read_recording(out / "recordings" / file)
        segments = label_recording(recording, classifier)
        feature_rows.append({"file": file, **recording_features(recording), "error": None})
        rows += label_rows(file, recording, segments)
        entries.append(_entry(case, recording, segments, out / "audio" / file))
    write_table(out / "features.csv", ("file", *recording_feature_names(), "error"), feature_rows)
    with locked(out / "labels.csv"):
        LabelTable(with_corrections(out / "labels.csv", rows)).write(out / "labels.csv")
    write_report(
        out / "report.html",
        entries,
        title="Creak, squawk and squeal of a rubber bushing",
        summary=(
            "Three conditions at which the fluorocarbon bushing made a noise on the rig, and one "
            "at which PDMS made none: simulated, radiated through the baseplate, labelled from "
            "the recordings alone."
        ),
    )


def _entry(case: Case, recording: Recording, segments: list[Segment], audio: Path) -> ReportEntry:
    sound = audible(recording, _RATE)
    full_scale = max(QUIETEST_FULL_SCALE, common_full_scale([sound]))
    write_audio(audio, sound, _RATE, full_scale=full_scale, recording=recording)
    return ReportEntry(
        title=case.name.capitalize() if case.name != "none" else "Silence",
        recording=recording,
        segment=file_label(segments),
        audio=audio,
        note=f"Simulated: {case.source} of De Togni's thesis.",
        full_scale=full_scale,
    )

"""Demonstration of the whole chain: simulated creak, squawk, squeal and silence, and a report.

The conditions are those of Figures 5.21, 5.22 and 5.24 of the thesis, and PDMS for comparison,
which is silent at every speed (Section 5.1.2).
Simulated hammer hits on the modelled clamp and beams, without the bushing and at a distance `ARM`
from the axis, are examples for ``bushing-noise frf``.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from features.table import recording_feature_names, recording_features
from models.radiation.impulse_responses import convolve
from models.radiation.rig_response import impulse_responses
from models.recording import Recording
from models.rig_file import load_material_rig
from noise.audio.gain import QUIETEST_FULL_SCALE, common_full_scale
from noise.audio.render import write_audio
from noise.audio.sound import audible
from noise.base.files import atomic, locked
from noise.base.progress import say, track
from noise.base.tables import write_table
from noise.classifier import load_classifier
from noise.labels.corrections import with_corrections
from noise.labels.rows import label_rows
from noise.labels.segments import label_recording
from noise.labels.table import LabelTable
from noise.pages.review import review
from noise.recordings import read_recording, write_recording
from sim.run import simulate


@dataclass(frozen=True)
class Case:
    """Condition of the demonstration.

    Parameters
    ----------
    name : str
        Expected label.
    material : str
    speed, interference, support_stiffness : float
        [rad/s], [m], [Nm/rad]
    """

    name: str
    material: str
    speed: float
    interference: float
    support_stiffness: float


CASES = (
    Case("creak", "fluorocarbon", 1.0, 0.381e-3, 2214.0),
    Case("squawk", "fluorocarbon", 5.0, 0.279e-3, 2214.0),
    Case("squeal", "fluorocarbon", 10.0, 0.279e-3, 3745.0),
    Case("none", "PDMS", 5.0, 0.381e-3, 2214.0),
)

_SECONDS = 2.0
"""Length of each recording [s]."""


def run_demo(out: Path, *, seed: int = 0) -> list[dict[str, object]]:
    """Simulate, render and label the four cases and write a report.

    Parameters
    ----------
    out : Path
        Output folder for ``recordings/``, ``audio/``, ``hits/``, ``features.csv``, ``labels.csv``
        and ``report.html``.
    seed : int
        Seed of the sensor noise.

    Returns
    -------
    list of dict
        Rows of the label table.

    Raises
    ------
    ParameterError
        The folder cannot be written.
    """
    out = Path(out)
    say("the first simulation takes longest: it compiles the solver")
    *generators, hammer = np.random.default_rng(seed).spawn(len(CASES) + 1)
    for case, rng in track(list(zip(CASES, generators, strict=True)), "simulating"):
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

    classifier = load_classifier()
    feature_rows, rows = [], []
    for case in track(CASES, "labelling"):
        file = f"{case.name}.wav"
        # Read back, so that a simulated recording is treated like a measured one.
        recording = read_recording(out / "recordings" / file)
        segments = label_recording(recording, classifier)
        feature_rows.append({"file": file, **recording_features(recording), "error": None})
        rows += label_rows(file, recording, segments)
        _write_sound(recording, out / "audio" / file)
    write_table(out / "features.csv", ("file", *recording_feature_names(), "error"), feature_rows)
    with locked(out / "labels.csv"):
        LabelTable(with_corrections(out / "labels.csv", rows)).write(out / "labels.csv")
    review(
        [*(out / "recordings" / f"{case.name}.wav" for case in CASES), out / "labels.csv"],
        out / "report.html",
        title="Creak, squawk and squeal of a rubber bushing",
        classify=False,
    )
    return rows


def _write_sound(recording: Recording, path: Path) -> None:
    """Write the audible sound of a recording."""
    sound = audible(recording)
    full_scale = max(QUIETEST_FULL_SCALE, common_full_scale([sound]))
    write_audio(path, sound, full_scale=full_scale, recording=recording)


ARM = 0.05
"""Lever arm of the hammer [m]."""

N_HITS = 5

_HIT_SUPPORT = 2214.0  # Nm/rad
_HIT_RATE = 25_600  # Hz
_HIT_SECONDS = 0.8  # the response has decayed by then
_PULSE_START = 0.01  # s
_PULSE_LENGTH = 0.25e-3  # s, with a hard tip
_FORCE = (40.0, 90.0)  # N
_FORCE_NOISE, _ACCELERATION_NOISE = 0.02, 0.02  # rms, N and m/s2


def write_hits(folder: Path, rng: np.random.Generator) -> None:
    """Write `N_HITS` hammer hits as NPY files of time [s], force [N] and acceleration [m/s2].

    Parameters
    ----------
    folder : Path
        Output folder, made if necessary.
    rng : numpy.random.Generator
        Generator for peak forces and sensor noise.

    Raises
    ------
    ParameterError
        The folder cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_hits(Path(folder) / "hits", np.random.default_rng(0))
    ...     np.load(Path(folder) / "hits" / "hit-1.npy").shape
    (3, 20480)
    """
    paths = impulse_responses(load_material_rig("fluorocarbon"), 0.279e-3, _HIT_SUPPORT, _HIT_RATE)
    time = np.arange(round(_HIT_SECONDS * _HIT_RATE)) / _HIT_RATE
    during = (time >= _PULSE_START) & (time < _PULSE_START + _PULSE_LENGTH)
    pulse = np.where(during, np.sin(np.pi * (time - _PULSE_START) / _PULSE_LENGTH), 0.0)
    for number in range(1, N_HITS + 1):
        force = rng.uniform(*_FORCE) * pulse
        acceleration = convolve(ARM * force, paths.torque_to_acceleration)
        force = force + _FORCE_NOISE * rng.standard_normal(time.size)
        acceleration = acceleration + _ACCELERATION_NOISE * rng.standard_normal(time.size)
        with atomic(folder / f"hit-{number}.npy") as target, target.open("wb") as file:
            np.save(file, np.stack([time, force, acceleration]))

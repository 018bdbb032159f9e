"""One small valid file of each kind that a command reads, which mutations begin with."""

from __future__ import annotations

import base64
import json
import shutil
from importlib import resources
from typing import TYPE_CHECKING

import numpy as np
import soundfile

from models.transfer_functions.uff import TIME_RESPONSE, UffFunction, write_uff_functions
from noise.base.tables import write_table
from noise.batch import file_identity, journal_path
from noise.batch.journal import open_journal
from noise.batch.work import Done, Job
from noise.labels.labelling import Labelling
from noise.labels.table import COLUMNS
from noise.labels.tracks import label_track
from noise.pages.diagnosis import write_diagnosis
from noise.training.classifier.described_samples import Sample
from noise.training.classifier.kept_samples import save_samples
from tests.helpers.logger_files import WRITERS, Wave
from tests.helpers.made_diagnoses import one_effect
from tests.helpers.made_reviews import row, screen_rows, write_screen
from tests.helpers.small_rigs import RIG_FILE

if TYPE_CHECKING:
    from pathlib import Path

RATE = 48_000
N = 2400  # samples of a recording

SIDECAR = {
    "channels": [{"name": "pressure", "unit": "Pa", "position_m": [0.1, 0.0, 0.5]}],
    "conditions": {
        "speed_rad_s": 5.0, "interference_mm": 0.279, "support_stiffness_Nm_rad": 2214.0,
        "material": "fluorocarbon", "temperature_C": 23.0,
    },
    "calibrated": True,
    "notes": ["made for a test"],
}  # fmt: skip

EFFECTS = """\
from sim.effects.effect import Effect, Stage
from sim.parameters import Parameter


def sensors(signals, rate, form, values, rng):
    return signals | {"torque": signals["torque"] + values["offset"]}


OFFSET = {"offset": Parameter(0.5, "Nm", -50.0, 50.0, "of the torque cell")}
EFFECT = Effect("zero_offset", Stage.MEASUREMENT, ("constant",), OFFSET, "offset", sensors=sensors)
"""

RESPONSE = "\n".join(
    [
        "frequency_hz,real,imag",
        *(f"{100.0 + 150.0 * k},{0.01 * k:.3f},{-0.002 * k:.3f}" for k in range(40)),
    ]
)

DESIGN = """\
base = "fluorocarbon"
[design]
name = "given"
speed_rad_s = [1, 5]
interference_mm = [0.279]
support_stiffness_Nm_rad = [2214]
temperature_C = [23]
oscillation = { amplitude_deg = 15, frequency_hz = [1, 2] }
heard = { motion = "swing", swing = { amplitude_deg = 9, frequency_hz = 3 }, temperature_C = 40 }
"""

RESPONSES = """
[[measured_response]]
support_stiffness_Nm_rad = 2214.0
torque_to_pressure = "given.%s"
"""

NUMBERS = """\
item,value,unit,interference_mm,support_stiffness_Nm_rad,speed_rad_s,error_percent
slip_frequency,155,Hz,0.279,fixed,1,5
effective_stiffness,640,Nm/rad,0.279,2214,,2
"""

LOG = "time_s,speed_rad_s\n" + "".join(f"{0.01 * k:.2f},{5 + 0.1 * k:.1f}\n" for k in range(20))

PAGE = """<html><script data-recording="run.wav" data-role="measured" data-full-scale="1.0">
SOUND</script></html>"""


def write_valid_files(folder: Path) -> None:
    """Write them, each called ``valid`` and after what it holds."""
    rng = np.random.default_rng(7)
    sound = 0.1 * rng.normal(size=(N, 1))
    for name, subtype in {
        "float.wav": "FLOAT", "pcm.wav": "PCM_16", "pcm.flac": "PCM_16", "pcm.aiff": "PCM_24",
        "vorbis.ogg": "VORBIS", "layer.mp3": "MPEG_LAYER_III",
    }.items():  # fmt: skip
        soundfile.write(folder / name, sound, RATE, subtype=subtype)
    waves = [Wave("mic", "Pa", rng.normal(size=300)), Wave("torque", "Nm", rng.normal(size=300))]
    for ending, write in WRITERS.items():
        write(folder / f"logger{ending}", waves, {"speed_rad_s": 5.0, "material": "PDMS"})
    function = UffFunction(TIME_RESPONSE, np.arange(300) / 51_200.0, rng.normal(size=300), "Pa")
    write_uff_functions(folder / "logger.uff", [function])
    _write_texts(folder)
    _write_diagnosis(folder)
    _write_tables(folder)
    _write_arrays(folder)


def _write_texts(folder: Path) -> None:
    rigs = {f"rig_{ending}.toml": f"{RIG_FILE}{RESPONSES % ending}" for ending in ("csv", "npz")}
    for name, content in {
        "sidecar.json": json.dumps(SIDECAR), "rig.toml": RIG_FILE, **rigs, "design.toml": DESIGN,
        "response.csv": RESPONSE, "numbers.csv": NUMBERS, "log.csv": LOG, "effects.py": EFFECTS,
        "track.txt": label_track([row("given.wav", "creak", 0.0, 0.05)]),
    }.items():  # fmt: skip
        (folder / name).write_text(content, encoding="utf-8")


def _write_diagnosis(folder: Path) -> None:
    write_diagnosis(folder / "diagnosis", one_effect())
    shutil.move(folder / "diagnosis" / "diagnosis.json", folder / "diagnosis.json")
    sound = base64.b64encode((folder / "pcm.flac").read_bytes()).decode()
    (folder / "report.html").write_text(PAGE.replace("SOUND", sound), encoding="utf-8")


def _write_tables(folder: Path) -> None:
    rows = [row("given.wav", "creak", 0.0, 0.02), row("given.wav", "none", 0.02, 0.05)]
    for ending in (".csv", ".jsonl", ".parquet", ".xlsx"):
        write_table(folder / f"labels{ending}", COLUMNS, rows)
    with open_journal(folder / "labels.csv", Labelling()) as journal:
        job = Job(0, folder / "float.wav", "run.wav")
        journal.keep(job, file_identity(job.path), Done([list(rows[0].values())], True))
    shutil.move(journal_path(folder / "labels.csv"), folder / "labels.csv.journal")
    shutil.move(write_screen(folder / "screen", screen_rows()) / "map.csv", folder / "map.csv")


def _write_arrays(folder: Path) -> None:
    time = np.arange(1000) / 20_000.0
    hit = np.column_stack(
        [time, 100.0 * np.exp(-(((time - 2e-3) / 2e-4) ** 2)), np.sin(900.0 * time)]
    )
    np.save(folder / "hit.npy", hit)
    np.savetxt(folder / "hit.csv", hit[:300], "%.6g", ",", header="time,force,response")
    for package, name in (("noise.classifier", "classifier"), ("noise.inference", "conditions")):
        with resources.as_file(resources.files(package) / "data" / f"{name}.npz") as path:
            shutil.copy(path, folder / f"{name}.npz")
    frequency = 100.0 + 150.0 * np.arange(40)
    np.savez(
        folder / "response.npz", frequency_hz=frequency, response=0.1 + 0.01j * frequency,
        coherence=np.full(40, 0.9), input_unit="N m", output_unit="Pa",
    )  # fmt: skip
    samples = [Sample(np.zeros((2, 3), np.float32), "creak", False, "bushing")]
    save_samples(folder / "samples.npz", (0, 1), samples)

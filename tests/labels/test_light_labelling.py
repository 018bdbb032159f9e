"""Labelling loads what it needs and no more: no simulator, no training, nothing that only shows."""

import subprocess
import sys

import numpy as np

from models.recording import Channel, Recording
from noise.recordings import write_recording

_CODE = """
import sys
from noise.cli import main
assert main(["label", sys.argv[1], "--out", sys.argv[2]]) == 0
unneeded = ("sim.", "noise.training", "noise.diagnosis", "noise.screening", "noise.pages",
            "sklearn", "matplotlib", "jinja2", "librosa")
print([name for name in sys.modules if name.startswith(unneeded)], file=sys.stderr)
"""


def test_labelling_loads_neither_simulator_nor_training(tmp_path):
    noise = np.random.default_rng(0).normal(size=(1, 20_000))
    path = write_recording(tmp_path / "a", Recording(noise, 20e3, (Channel("pressure"),)))
    call = [sys.executable, "-c", _CODE, str(path), str(tmp_path / "labels.csv")]
    said = subprocess.run(call, capture_output=True, text=True, check=True).stderr
    assert said.splitlines()[-1] == "[]"

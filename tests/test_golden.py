"""Golden outputs: the comparison sees what differs; the program still gives what it gave."""

import json
import os
from pathlib import Path

import numpy as np
import pytest
import soundfile as sf

from tests.golden import differences, make

FOLDER = os.environ.get("BUSHING_NOISE_GOLDEN")


@pytest.fixture
def outputs(tmp_path):
    """Two folders with the same recording, table and JSON file."""
    pair = [tmp_path / "before", tmp_path / "after"]
    for folder in pair:
        folder.mkdir()
        sf.write(folder / "x.wav", np.linspace(-1, 1, 100), 8000, subtype="FLOAT")
        (folder / "x.csv").write_text("file,level_db\nx.wav,94.0\n")
        (folder / "x.json").write_text(json.dumps({"gap": [1.0, float("nan")], "seconds": 1.0}))
    return pair


def test_equal_folders_have_no_differences(outputs):
    (outputs[1] / "x.json").write_text(json.dumps({"gap": [1.0, float("nan")], "seconds": 7.0}))
    assert differences(*outputs) == []


def test_each_kind_of_difference_is_listed(outputs):
    samples = np.linspace(-1, 1, 100).astype("f4")
    sf.write(outputs[1] / "x.wav", np.nextafter(samples, 2), 8000, subtype="FLOAT")
    (outputs[1] / "x.csv").write_text("file,level_db\nx.wav,94.1\n")
    (outputs[1] / "x.json").write_text(json.dumps({"gap": [1.0], "seconds": 1.0}))
    (outputs[1] / "y.toml").write_text("")
    assert [line.split(":")[0] for line in differences(*outputs)] == [
        "x.csv",
        "x.json",
        "x.wav",
        "y.toml",
    ]


@pytest.mark.slow
@pytest.mark.skipif(not FOLDER, reason="BUSHING_NOISE_GOLDEN names no folder of outputs")
def test_outputs_are_those_of_the_folder(tmp_path):
    make(tmp_path)
    assert differences(tmp_path, Path(FOLDER)) == []

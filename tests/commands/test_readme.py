"""The README, as somebody follows it who pastes one block after the other into an empty folder."""

import numpy as np
import pytest
import soundfile

from noise.cli import main
from noise.commands import COMMANDS
from noise.recordings import read_recording
from tests.helpers.readme_blocks import SERVING, blocks, paths, quoted, readme, walk

BLOCKS = blocks(readme())
COMMAND_LINES = [line for block in BLOCKS if block.kind == "commands" for line in block.commands]

DEAR = ("diagnose", "identify", "screen", "thesis", "train")
"""Commands that take a minute or more."""


@pytest.fixture(autouse=True)
def _no_window(monkeypatch):
    monkeypatch.setenv("MPLBACKEND", "Agg")


def refused(said):
    return [(" ".join(one.line), one.err) for one in said if one.code != 0]


def missing(folder, said):
    """Files that a command named on its standard output, and that are not there."""
    lines = [(one, line) for one in said for line in one.out.splitlines()]
    named = [(one, line) for one, line in lines if "." in line and "  " not in line]
    return [
        (" ".join(one.line), line)
        for one, line in named
        if one.line[0] not in ("screen", "thesis") and not (folder / line).exists()
    ]


def test_every_command_is_shown():
    assert {line[0] for line in COMMAND_LINES} == set(COMMANDS)


@pytest.mark.parametrize("line", COMMAND_LINES, ids=" ".join)
def test_every_option_is_one_of_its_command(line, capsys):
    assert main([line[0], "--help"]) == 0
    told = capsys.readouterr().out
    assert [word for word in line if word.startswith("--") and word.split()[0] not in told] == []


def test_blocks_run_in_order_from_an_empty_folder(tmp_path):
    said = walk(tmp_path, dear=DEAR)
    assert refused(said) == []
    assert missing(tmp_path, said) == []
    assert len(said) > len(COMMAND_LINES) / 2


def test_the_sidecar_makes_a_recording_of_plain_samples(tmp_path):
    (sidecar,) = (block for block in BLOCKS if block.kind == "sidecar")
    samples = np.stack([np.full(480, 8.0), np.zeros(480)], axis=1)
    soundfile.write(tmp_path / "run08.wav", samples, 30000, subtype="FLOAT")
    (tmp_path / "run08.json").write_text(sidecar.text, encoding="utf-8")
    read = read_recording(tmp_path / "run08.wav")
    assert read.channel_names == ("torque", "pressure")
    assert float(read["torque"].mean()) == 8.0
    assert read.condition.interference == pytest.approx(0.279e-3)


@pytest.mark.slow
def test_all_blocks_run_and_do_what_the_text_says(tmp_path):
    said = walk(tmp_path)
    assert refused(said) == []
    assert missing(tmp_path, said) == []
    assert [one.line for one in said] == [x for x in COMMAND_LINES if x[0] not in SERVING]
    named = [path for path in paths(readme()) if not path.startswith(("tests/", "sim/", "models/"))]
    assert len(named) > 3
    assert [path for path in named if not (tmp_path / path).is_file()] == []
    printed = " ".join(" ".join(one.out.split() + one.err.split()) for one in said)
    phrases = quoted(readme("Tutorial"))
    assert len(phrases) > 3
    assert [phrase for phrase in phrases if phrase not in printed] == []

"""The tutorial of the README, as somebody follows it who pastes one block after the other."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from noise.cli import main
from noise.commands import COMMANDS
from tests.helpers.readme_blocks import blocks, paths, section

TUTORIAL = section("Tutorial")
BLOCKS = blocks(TUTORIAL)
COMMAND_LINES = [line for block in BLOCKS if block.kind == "commands" for line in block.commands]
ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def followed(tmp_path_factory):
    """The folder after all blocks, and what each command said."""
    folder = tmp_path_factory.mktemp("tutorial")
    said = []
    for block in BLOCKS:
        if block.kind == "file":
            (folder / block.name).write_text(block.text, encoding="utf-8")
        elif block.kind == "python":
            said.append((["python"], run(folder, "-c", block.text)))
        else:
            said += [(line, run(folder, "-m", "noise", *line)) for line in block.commands]
    return folder, said


def run(folder, *arguments):
    """Run Python on the sources beside this test, in a folder of the user's."""
    environment = os.environ | {"PYTHONPATH": str(ROOT), "MPLBACKEND": "Agg"}
    return subprocess.run(
        [sys.executable, *arguments],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        encoding="utf-8",
        check=False,
    )


def test_the_tutorial_goes_from_designs_recordings_and_a_disagreement():
    used = [line[0] for line in COMMAND_LINES]
    assert {"screen", "label", "review", "diagnose"} <= set(used)
    assert set(used) <= set(COMMANDS)
    assert [block.kind for block in BLOCKS].count("python") == 1


@pytest.mark.parametrize("line", COMMAND_LINES, ids=lambda line: " ".join(line[:2]))
def test_every_option_is_one_of_its_command(line, capsys):
    assert main([line[0], "--help"]) == 0
    told = capsys.readouterr().out
    assert [word for word in line if word.startswith("--") and word not in told] == []


@pytest.mark.slow
def test_every_block_does_what_it_is_for(followed):
    _, said = followed
    failed = [(line, done.stderr) for line, done in said if done.returncode != 0]
    assert failed == []


@pytest.mark.slow
def test_files_are_where_the_tutorial_says(followed):
    folder, _ = followed
    named = paths(TUTORIAL)
    assert len(named) > 3
    assert [path for path in named if not (folder / path).is_file()] == []


@pytest.mark.slow
def test_the_diagnosis_names_the_cause_that_was_put_in(followed):
    _, said = followed
    (diagnosed,) = (done for line, done in said if line[0] == "diagnose")
    assert "The simulation lacks partial slip: " in diagnosed.stderr

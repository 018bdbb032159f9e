"""The program around the commands: help, exit codes, interrupts, a closed pipe, a full disk."""

import argparse
import os
import shutil
import subprocess
import sys
import tomllib
import warnings
from importlib.metadata import version
from pathlib import Path

import pytest

from models.errors import RecordingError
from noise.cli import main
from noise.commands import COMMANDS, load_command
from noise.commands.options import COMMON, add_options, help_of, option_names

HELP = Path(__file__).parents[2] / "noise" / "commands" / "help.toml"
HEAVY = ("numpy", "scipy", "sklearn", "librosa", "matplotlib", "numba", "soundfile")


def test_help_loads_nothing_that_computes():
    program = (
        "import sys; from noise.cli import main\n"
        f"for command in {[[], *([name] for name in COMMANDS)]}: main([*command, '--help'])\n"
        f"print([name for name in {HEAVY} if name in sys.modules], file=sys.stderr)"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert done.stderr == "[]\n"
    assert all(f"bushing-noise {name} " in done.stdout for name in COMMANDS)


def test_the_package_runs_as_a_module_and_tells_the_installed_version():
    done = subprocess.run(
        [sys.executable, "-m", "noise", "--version"], capture_output=True, text=True
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout == f"bushing-noise {version('bushing-noise')}\n"


@pytest.mark.skipif(os.name == "nt", reason="pipes close otherwise on Windows")
def test_a_reader_that_goes_away_is_no_error():
    program = subprocess.Popen(
        [sys.executable, "-c", "from noise.cli import main; import sys; sys.stdin.read();"
         "sys.exit(main(['--version']))"],
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
    )  # fmt: skip
    program.stdout.close()
    program.stdout = None
    _, err = program.communicate(b"")
    assert (program.returncode, err) == (141, b"")


@pytest.mark.parametrize("name", COMMANDS)
def test_every_option_is_explained_and_every_command_takes_a_seed(name):
    parser = argparse.ArgumentParser(prog=name)
    (description, _, texts), rows = help_of(name), [*load_command(name).OPTIONS, *COMMON]
    add_options(parser, rows, texts)
    assert description
    own = tomllib.loads(HELP.read_text(encoding="utf-8"))[name].get("options", {})
    assert set(own) <= set(option_names(rows))
    assert parser.get_default("seed") == 0
    for action in parser._actions:
        assert action.help
        has_default = action.option_strings and action.nargs != 0 and action.default is not None
        assert not has_default or "default: " in action.help


def failing(error):
    def simulate(*_, **__):
        warnings.warn("the rig is warm", UserWarning, stacklevel=1)
        raise error

    return simulate


@pytest.mark.parametrize(
    ("error", "code", "said"),
    [
        (RecordingError("run07.wav: is\nempty"), 1, "bushing-noise: refused: run07.wav: is empty"),
        (MemoryError(), 3, "bushing-noise: error: this needs more memory than there is"),
        (KeyboardInterrupt(), 130, "bushing-noise: interrupted"),
        (ZeroDivisionError("x"), 3, "bushing-noise: error: unexpected, please report: ZeroDiv"),
        (OSError(28, "No space left"), 3, "bushing-noise: error: output: No space left"),
        (OSError(13, "Not allowed", "a.csv"), 2, "bushing-noise: error: a.csv: Not allowed"),
    ],
)
def test_whatever_goes_wrong_is_one_line_and_a_code(monkeypatch, capsys, error, code, said):
    monkeypatch.setattr("sim.run.simulate", failing(error))
    monkeypatch.setattr("noise.cli.discard", lambda *_: None)
    assert main(["simulate", "--speed", "1"]) == code
    err = capsys.readouterr().err.splitlines()
    assert err[-2] == "bushing-noise: note: the rig is warm"
    assert err[-1].startswith(said)


@pytest.mark.skipif(os.name == "nt", reason="limits the size of files as Unix does")
def test_a_full_disk_is_one_line_and_a_code_of_its_own_and_leaves_nothing(tmp_path, capsys):
    import resource

    call = ["simulate", "--speed", "5", "--seconds", "0.5"]
    first = tmp_path / "first" / "run"
    assert main([*call, "--out", str(first)]) == 0  # compilers keep their results in files, too
    shutil.rmtree(first.parent)
    capsys.readouterr()
    unlimited = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, unlimited[1]))
    try:
        code = main([*call, "--out", str(tmp_path / "run")])
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, unlimited)
    err = capsys.readouterr().err
    assert code == 3
    assert "cannot be written" in err.splitlines()[-1]
    assert "Traceback" not in err
    assert list(tmp_path.iterdir()) == []


INTERRUPTED = """
import os, signal, sys

class Interrupt:
    def find_spec(self, name, path=None, target=None):
        if name == os.environ["AT"]:
            os.kill(os.getpid(), signal.SIGINT)

sys.meta_path.insert(0, Interrupt())
from noise.__main__ import run
run()
"""


@pytest.mark.parametrize("at", ["noise.cli", "noise.recordings"])
def test_an_interrupt_while_a_command_is_loaded_is_one_line(tmp_path, at):
    script = tmp_path / "bushing-noise"
    script.write_text(INTERRUPTED)
    done = subprocess.run(
        [sys.executable, script, "features", str(tmp_path)], capture_output=True, text=True,
        env={**os.environ, "AT": at, "PYTHONPATH": str(Path(__file__).parents[2])},
    )  # fmt: skip
    assert (done.returncode, done.stderr) == (130, "bushing-noise: interrupted\n")

"""An installation that a user shares: nothing in it can be written, no home, no network."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import sysconfig
import tempfile
from pathlib import Path

import pytest

from noise.commands import COMMANDS

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(sys.platform != "linux", reason="takes rights away as Linux does"),
]

ROOT = Path(__file__).parents[2]
AS_NOBODY = ("setpriv", "--reuid=65534", "--regid=65534", "--clear-groups")

WITHOUT_NETWORK = """
import fcntl, os, socket, struct, sys
with socket.socket() as any:  # what remains is this machine itself
    fcntl.ioctl(any, 0x8914, struct.pack("16sh14x", b"lo", 1))
os.execvp(sys.argv[1], sys.argv[1:])
"""

MAP = ("--speed", "1,5", "--interference", "0.279", "--support-stiffness", "2214", "--sounds", "1")
CALLS = {
    "demo": ["--out", "demo"],
    "simulate": ["--speed", "5", "--seconds", "0.5", "--out", "run"],
    "render": ["demo/recordings", "--out", "set"],
    "features": ["demo/recordings", "--out", "features.csv"],
    "label": ["demo/recordings", "--out", "labels.csv", "--workers", "2"],
    "screen": ["PDMS", *MAP, "--simulations", "4", "--no-tolerances", "--out", "map"],
    "frf": ["demo/hits", "--out", "response.npz"],
    "diagnose": ["run.wav", "--rig", "rig.toml", "--quick", "--out", "diagnosis"],
    "identify": ["run.wav", "--out", "mine"],
    "review": ["demo/recordings", "--out", "review.html"],
    "train": ["--samples", "20", "--out", "mine.npz"],
    "open": ["demo/recordings", "--no-browser"],
    "thesis": ["--out", "thesis.csv"],
}  # fmt: skip


@pytest.fixture(scope="module")
def place():
    """A folder that others may pass through: pytest keeps its own to one user, again and again."""
    with tempfile.TemporaryDirectory() as folder:
        Path(folder).chmod(0o755)
        yield Path(folder)


@pytest.fixture(scope="module")
def installed(place):
    """The command of an installation from a wheel, none of whose files may be written."""
    venv = place / "venv"
    subprocess.run([_shared_python(), "-m", "venv", "--without-pip", venv], check=True)
    python = venv / "bin" / "python"
    done = subprocess.run(
        [sys.executable, "-m", "pip", "--python", python, "install", "--quiet", "--no-deps", ROOT],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    if done.returncode:
        pytest.skip(f"no wheel can be built: {done.stderr[-300:]}")
    packages = Path(sysconfig.get_path("purelib", vars={"base": str(venv)}))
    # The libraries are those that the tests have; of them, too, nothing may be written.
    (packages / "libraries.pth").write_text(f"{sysconfig.get_path('purelib')}\n")
    folders = [path for path in venv.rglob("*") if path.is_dir() and not path.is_symlink()]
    for path in (venv, *folders):
        path.chmod(0o555)
    yield venv / "bin" / "bushing-noise"
    for path in (venv, *folders):
        path.chmod(0o755)


@pytest.fixture(scope="module")
def without_rights(installed):
    """What to put before a command: another user where there can be one, no network."""
    if os.geteuid() != 0 or not shutil.which("setpriv"):
        return []  # the user has no rights to lose, and the network stays
    before = []
    alone = ["unshare", "--net", "--", sys.executable, "-c", WITHOUT_NETWORK]
    if subprocess.run([*alone, "/bin/true"], capture_output=True, check=False).returncode == 0:
        before = alone
    if _others_can(installed.with_name("python"), "import numpy, noise"):
        return [*before, *AS_NOBODY]
    return [*before, "setpriv", "--bounding-set=-all", "--inh-caps=-all"]  # its Python is root's


def _shared_python():
    """The Python of the tests, or one of its version, that others can start as well."""
    version = f"python{sys.version_info[0]}.{sys.version_info[1]}"
    there = [sys.executable, shutil.which(version, path=os.defpath)]
    return next((one for one in there if one and _others_can(one, "import venv")), sys.executable)


def _others_can(python, statement):
    # Through a shell, since setpriv itself starts a program with the rights that it gives away.
    asked = [*AS_NOBODY, "/bin/sh", "-c", '"$0" -c "$1"', python, statement]
    try:
        return subprocess.run(asked, capture_output=True, check=False).returncode == 0
    except OSError:  # there is no setpriv
        return False


@pytest.fixture(scope="module")
def folder(place):
    work = place / "work"
    work.mkdir()
    work.chmod(0o777)
    (work / "rig.toml").write_text('base = "fluorocarbon"\n')
    (work / "temporary").mkdir()
    (work / "temporary").chmod(0o1777)  # as /tmp is
    return work


def test_each_command_runs_and_writes_nothing_there(installed, without_rights, folder):
    assert set(CALLS) == set(COMMANDS)
    environment = {"PATH": os.environ["PATH"], "TMPDIR": str(folder / "temporary")}
    before = set(installed.parents[1].rglob("*"))
    for command, given in CALLS.items():
        process = subprocess.Popen(
            [*without_rights, installed, command, *given], cwd=folder, env=environment,
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        )  # fmt: skip
        ends = (0,)
        if command == "open":
            assert process.stdout.readline().startswith("http://127.0.0.1:"), process.communicate()
            process.send_signal(signal.SIGINT)
            ends = (0, 130)
        _, told = process.communicate()
        assert process.returncode in ends, f"{command}: {told}"
        assert "Traceback" not in told
        assert "Matplotlib" not in told  # which would tell of its folder in three lines
    assert set(installed.parents[1].rglob("*")) == before

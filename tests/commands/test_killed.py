"""Commands killed anywhere on their way and called again: as if nothing had happened."""

from __future__ import annotations

import os
import re
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from noise.batch import journal_path
from noise.cli import main
from tests.helpers import dying_command
from tests.helpers.batch_work import make_recordings

pytestmark = pytest.mark.skipif(os.name == "nt", reason="has no SIGKILL")

ROOT = Path(__file__).parents[2]
ENVIRONMENT = {**os.environ, "PYTHONPATH": str(ROOT)}
SHARES = (0.0, 0.1, 0.5, 0.9)

BENCH = [
    ["simulate", "--speed", str(n), "--seconds", "0.5", "--seed", str(n), "--out", f"bench/{n}"]
    for n in (1, 2, 3)
]
MORE = ["--effect", "velocity_weakening:share=0.4", "--effect", "partial_slip:share=0.9"]
BENCH += [
    ["simulate", "--speed", str(n), "--seconds", "0.5", *MORE, "--out", f"more/{n}"]
    for n in (1, 2, 4)
]
MAP = ("--speed", "1,5", "--interference", "0.279", "--support-stiffness", "2214")
CALLS = {
    "render": ["render", "bench", "--out", "set"],
    "render, simulated": ["render", "--interference 0.279", "--interference 0.381", "--speed", "5",
                          "--seconds", "0.3", "--out", "set"],
    "screen": ["screen", "PDMS", *MAP, "--simulations", "4", "--no-tolerances", "--sounds", "1",
               "--out", "screen"],
    "diagnose": ["diagnose", "bench", "--rig", "rig.toml", "--quick", "--out", "diagnosis"],
    "train": ["train", "--samples", "20", "--keep", "kept.npz", "--out", "mine.npz"],
}  # fmt: skip

_TOOK = re.compile(rb'"seconds": [\d.]+|Screened in [\d.]+ s|Time taken</dt><dd>[\d.]+ s')
"""How long it took is told, and differs."""


def contents(folder):
    """All files of a folder, hidden ones as well, but for journals."""
    return {
        path.relative_to(folder).as_posix(): _TOOK.sub(b"", path.read_bytes())
        for path in folder.rglob("*")
        if path.is_file() and path.suffix != ".journal"
    }


@pytest.fixture(scope="module")
def bench(tmp_path_factory):
    folder = tmp_path_factory.mktemp("of") / "all"
    folder.mkdir()
    for call in BENCH:
        assert subprocess.run([sys.executable, "-m", "noise", *call], cwd=folder, env=ENVIRONMENT,
                              capture_output=True, check=False).returncode == 0  # fmt: skip
    (folder / "rig.toml").write_text('base = "fluorocarbon"\n')
    return folder


def run(folder, call, at=-1):
    """Run a command that dies at a moment; return its exit code and the number of moments."""
    told = folder.with_suffix(".told")
    script = Path(dying_command.__file__)
    done = subprocess.run(
        [sys.executable, script, str(at), told, *call], cwd=folder, env=ENVIRONMENT,
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert "Traceback" not in done.stderr, done.stderr
    return done.returncode, int(told.read_text()) if at < 0 else at


def is_as_if_never_killed(call, given, tmp_path, shares, *, twice=True):
    undisturbed = Path(shutil.copytree(given, tmp_path / "undisturbed"))
    code, n = run(undisturbed, call)
    assert code == 0
    assert n > 3
    for share in shares:
        folder = Path(shutil.copytree(given, tmp_path / f"at{share}"))
        # Twice, since what the first leaves is in the way of the second.
        ended, _ = run(folder, call, int(share * n))
        assert ended == -signal.SIGKILL
        if twice:  # unless what is kept of the first leaves too few moments to die at
            ended, _ = run(folder, call, min(int(share * n) + 1, n - 1))
            assert ended in (-signal.SIGKILL, 0)
        assert run(folder, call)[0] == 0
        assert contents(folder) == contents(undisturbed)


def test_a_set_of_sounds_killed_half_way_comes_out_as_if_it_had_not_been(tmp_path):
    make_recordings(tmp_path / "given" / "bench", 3, 1, 0.2)
    (tmp_path / "given" / "bench" / "day1" / "shift1" / "run0001.flac").unlink()
    is_as_if_never_killed(CALLS["render"], tmp_path / "given", tmp_path, [0.6], twice=False)


@pytest.mark.parametrize("command", CALLS)
@pytest.mark.slow
def test_a_command_killed_anywhere_comes_out_as_if_it_had_not_been(command, bench, tmp_path):
    is_as_if_never_killed(CALLS[command], bench, tmp_path, SHARES)


# With a journal


def start(call, folder):
    # Each folder has a cache of its own, where no other diagnosis has kept the cases of a rig.
    of_its_own = {"HOME": f"{folder}.home", "XDG_CACHE_HOME": f"{folder}.home/.cache"}
    return subprocess.Popen(
        [sys.executable, "-m", "noise", *call], cwd=folder, env=ENVIRONMENT | of_its_own,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip


def grown(process, journal, size):
    """Wait until a journal has a size [byte]; return what is in it."""
    while not journal.exists() or journal.stat().st_size < size:
        assert process.poll() is None, process.communicate()
        time.sleep(1e-3)


def lines_of(journal):
    return journal.read_bytes().rpartition(b"\n")[0].splitlines()


def goes_on_where_it_was(command, tmp_path, shares, n=36, n_broken=2, seconds=0.2):
    undisturbed = tmp_path / "undisturbed"
    make_recordings(undisturbed / "runs", n, n_broken, seconds)
    call = [command, "runs", "--out", "table.csv"]
    start(call, undisturbed).communicate()
    whole = journal_path(undisturbed / "table.csv")
    for share in shares:
        folder = tmp_path / f"at{share}"
        shutil.copytree(undisturbed / "runs", folder / "runs")
        journal = journal_path(folder / "table.csv")
        process = start(call, folder)
        grown(process, journal, share * whole.stat().st_size)
        process.kill()
        process.communicate()
        assert not (folder / "table.csv").exists()
        kept = lines_of(journal)
        assert len(kept) >= int(share * (n - n_broken))
        last = start(call, folder)
        _, told = last.communicate()
        assert last.returncode == 1
        if len(kept) > 1:
            assert f"{len(kept) - 1} of {n} recordings are done already" in told
        assert lines_of(journal)[: len(kept)] == kept  # nothing was done again
        assert len(lines_of(journal)) == len(lines_of(whole))
        assert contents(folder) == contents(undisturbed)


def held(process, journal, size=0):
    """Wait for a journal as `grown` does; give it a second name, which outlives the call."""
    grown(process, journal, size)
    second = journal.with_name("held.journal")
    if not second.exists():
        os.link(journal, second)
    return second


def simulates_and_measures_nothing_again(call, target, given, tmp_path, shares):
    """Of what a call keeps until it is done."""
    undisturbed = Path(shutil.copytree(given, tmp_path / "undisturbed"))
    journal = journal_path(Path(target))
    process = start(call, undisturbed)
    whole = held(process, undisturbed / journal)
    process.communicate()
    assert process.returncode == 0
    assert len(lines_of(whole)) > 3
    for share in shares:
        folder = Path(shutil.copytree(given, tmp_path / f"at{share}"))
        process = start(call, folder)
        kept = held(process, folder / journal, share * whole.stat().st_size)
        process.kill()
        process.communicate()
        before = lines_of(kept)
        last = start(call, folder)
        last.communicate()
        assert last.returncode == 0
        assert lines_of(kept)[: len(before)] == before
        assert len(lines_of(kept)) == len(lines_of(whole))  # each once
        assert contents(folder) == contents(undisturbed)
        assert not (folder / journal).exists()


KEEPING = {
    "screen": (["screen", "fluorocarbon", "PDMS", "--simulations", "200", "--no-tolerances",
                "--sounds", "1", "--out", "screen"], "screen/map.csv"),
    "train": (["train", "--samples", "20", "--out", "mine.npz"], "mine.npz"),
}  # fmt: skip


@pytest.mark.parametrize("command", KEEPING)
@pytest.mark.slow
def test_what_is_kept_until_it_is_done_is_not_done_again(command, bench, tmp_path):
    simulates_and_measures_nothing_again(*KEEPING[command], bench, tmp_path, SHARES)


@pytest.mark.slow
def test_a_diagnosis_killed_half_way_simulates_nothing_again(bench, tmp_path):
    call = ["diagnose", "more", "--rig", "rig.toml", "--out", "diagnosis"]
    simulates_and_measures_nothing_again(call, "diagnosis/report.html", bench, tmp_path, [0.5])


def test_labels_go_on_where_half_of_the_journal_was(tmp_path):
    goes_on_where_it_was("label", tmp_path, [0.5])


@pytest.mark.parametrize("command", ["label", "features"])
@pytest.mark.slow
def test_tables_go_on_where_the_journal_was(command, tmp_path):
    goes_on_where_it_was(command, tmp_path, SHARES, 60, 4, 0.5)


def workers_of(process):
    """Processes that work for another."""
    children = Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()
    return [
        int(pid) for pid in children if b"spawn_main" in Path(f"/proc/{pid}/cmdline").read_bytes()
    ]


@pytest.mark.parametrize("n", [36, pytest.param(120, marks=pytest.mark.slow)])
@pytest.mark.skipif(sys.platform != "linux", reason="tells no children of a process")
def test_one_of_two_workers_is_killed_and_the_table_is_the_same(tmp_path, n):
    make_recordings(tmp_path / "runs", n, 2, 0.2)
    process = start(["label", "runs", "--out", "two.csv", "--workers", "2"], tmp_path)
    grown(process, journal_path(tmp_path / "two.csv"), 500)
    os.kill(workers_of(process)[0], signal.SIGKILL)
    _, told = process.communicate()
    assert process.returncode == 1, told
    assert f"{n} recordings, 2 refused" in told
    assert main(["label", str(tmp_path / "runs"), "--out", str(tmp_path / "one.csv")]) == 1
    # A file that is refused is named as the call names it.
    said = (tmp_path / "one.csv").read_bytes().replace(os.fsencode(f"{tmp_path}/"), b"")
    assert (tmp_path / "two.csv").read_bytes() == said

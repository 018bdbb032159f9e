"""The identity of the program: of what can change a result, and of nothing else."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from noise.batch import identity
from noise.batch.identity import program_identity

ROOT = Path(identity.__file__).parents[2]


@pytest.fixture
def program(tmp_path, monkeypatch):
    """A copy of the program; calling it gives its identity."""
    passed = shutil.ignore_patterns("__pycache__")
    for package in ("models", "sim", "features", "noise"):
        shutil.copytree(ROOT / package, tmp_path / package, ignore=passed)
    return lambda: identity._digest(tmp_path)


def test_it_is_that_of_the_files_however_they_came_there(program):
    assert program() == identity._digest(ROOT) == program_identity()


@pytest.mark.parametrize(
    "path",
    [
        "sim/solvers/__pycache__/kernel.solve-133.py311.nbi",
        "sim/solvers/__pycache__/kernel.solve-133.py311.1.nbc",
        "noise/labels/__pycache__/table.cpython-311.pyc",
        "noise/labels/.table.py.swp",
    ],
)
def test_what_is_compiled_or_hidden_does_not_count(program, tmp_path, path):
    before = program()
    (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
    (tmp_path / path).write_bytes(b"machine code")
    assert program() == before


@pytest.mark.parametrize("ending", [".py", ".npz", ".toml"])
def test_an_edited_source_or_model_counts(program, tmp_path, ending):
    before = program()
    one = next(tmp_path.rglob(f"*{ending}"))
    one.write_bytes(one.read_bytes() + b"\n")
    changed = program()
    assert changed != before
    one.rename(one.with_stem("another"))
    assert program() not in (before, changed)


@pytest.mark.parametrize("library", ["numpy", "scipy", "numba", "librosa", "soundfile"])
def test_another_version_of_a_library_counts(program, monkeypatch, library):
    before, version = program(), identity.version
    monkeypatch.setattr(identity, "version", lambda name: version(name) + "1" * (name == library))
    assert program() != before

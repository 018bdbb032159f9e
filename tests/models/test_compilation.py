"""The folder for what numba compiles, where a user has none."""

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SHOW = "import os, models; f = os.environ.get('NUMBA_CACHE_DIR', ''); print(f)"
MODE = "; print(oct(os.stat(f).st_mode & 0o777), os.environ['MPLCONFIGDIR'] == f)"


def started(code, **environment):
    given = {"PYTHONPATH": str(ROOT), "PATH": "/usr/bin:/bin", **environment}
    done = subprocess.run(
        [sys.executable, "-c", code], env=given, capture_output=True, text=True, check=True
    )
    return done.stdout.split()


@pytest.fixture
def homeless(tmp_path):
    """A home that is no folder, so that nothing can be made in it, whoever runs the test."""
    (tmp_path / "home").write_text("")
    return {"HOME": str(tmp_path / "home"), "XDG_CACHE_HOME": str(tmp_path / "home" / "cache")}


def test_a_user_with_a_home_keeps_numbas_own_folder(tmp_path):
    assert started(SHOW, HOME=str(tmp_path)) == []


def test_a_user_without_one_gets_a_private_folder_that_goes_with_the_process(homeless, tmp_path):
    folder, mode, shared = started(SHOW + MODE, TMPDIR=str(tmp_path), **homeless)
    assert Path(folder).parent == tmp_path
    assert (mode, shared) == ("0o700", "True")
    assert not Path(folder).exists()


def test_a_folder_that_the_user_names_comes_first(homeless):
    assert started(SHOW, NUMBA_CACHE_DIR="/named", **homeless) == ["/named"]

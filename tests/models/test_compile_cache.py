"""The program starts where numba finds no folder for what it compiles."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from models import compile_cache
from models.compile_cache import ensure_compile_cache

VARIABLE = "NUMBA_CACHE_DIR"
ROOT = Path(__file__).parents[2]

pytestmark = pytest.mark.skipif(not hasattr(os, "getuid"), reason="folders have no owners here")


@pytest.fixture
def place(tmp_path, monkeypatch):
    """The user's folder among the temporary files, where nothing else can be written."""
    for name in (VARIABLE, "MPLCONFIGDIR"):
        monkeypatch.setenv(name, "")  # or else what is set here would stay
        monkeypatch.delenv(name)
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    writable = compile_cache._writable
    monkeypatch.setattr(
        compile_cache, "_writable", lambda path: path.is_relative_to(tmp_path) and writable(path)
    )
    numba = pytest.importorskip("numba")
    monkeypatch.setattr(numba.config, "CACHE_DIR", "")
    for name in ("core.dispatcher.Dispatcher", "np.ufunc.ufuncbuilder.UFuncDispatcher"):
        monkeypatch.setattr(f"numba.{name}.enable_caching", lambda _: "kept")
    tmp_path.chmod(0o700)
    return tmp_path / f"bushing-noise-{os.getuid()}"


def keeps_nothing(place, capsys):
    from numba.core.dispatcher import Dispatcher

    ensure_compile_cache()
    said = capsys.readouterr().err
    return (
        VARIABLE not in os.environ
        and Dispatcher.enable_caching(None) is None
        and said.count("\n") == 1
        and "no safe folder for compiled code" in said
    )


def test_the_user_gets_a_folder_that_nobody_else_may_look_into(place, capsys):
    import numba

    for _ in range(2):  # the second finds it
        ensure_compile_cache()
        assert os.environ[VARIABLE] == numba.config.CACHE_DIR == str(place)
        assert os.environ["MPLCONFIGDIR"] == str(place)
        assert place.stat().st_mode & 0o777 == 0o700
    assert capsys.readouterr().err == ""


def test_it_is_not_needed_where_the_users_own_cache_can_be_written(place, tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    if sys.platform == "linux":
        ensure_compile_cache()
        assert VARIABLE not in os.environ
        assert not place.exists()


def test_a_folder_that_the_user_names_stays(place, tmp_path, monkeypatch):
    monkeypatch.setenv(VARIABLE, str(tmp_path / "mine"))
    ensure_compile_cache()
    assert os.environ[VARIABLE] == str(tmp_path / "mine")
    assert not place.exists()


def test_a_folder_that_others_may_write_to_is_not_used(place, capsys):
    place.mkdir()
    place.chmod(0o770)
    assert keeps_nothing(place, capsys)


def test_a_link_is_not_used(place, tmp_path, capsys):
    (tmp_path / "theirs").mkdir(mode=0o700)
    place.symlink_to(tmp_path / "theirs")
    assert keeps_nothing(place, capsys)


def test_a_folder_of_another_user_is_not_used(place, capsys):
    place.mkdir(mode=0o700)
    try:
        os.chown(place, os.getuid() + 1, -1)
    except PermissionError:
        pytest.skip("only root gives folders away")
    assert keeps_nothing(place, capsys)


def test_a_folder_that_others_could_put_theirs_in_place_of_is_not_used(place, tmp_path, capsys):
    tmp_path.chmod(0o777)
    assert keeps_nothing(place, capsys)
    tmp_path.chmod(0o1777)
    place.rmdir()
    ensure_compile_cache()
    assert os.environ[VARIABLE] == str(place)


def test_a_folder_inherited_from_another_process_is_looked_at_again(place, capsys, monkeypatch):
    place.mkdir(mode=0o700)
    monkeypatch.setenv(VARIABLE, str(place))
    ensure_compile_cache()
    assert os.environ[VARIABLE] == str(place)
    place.chmod(0o777)
    assert keeps_nothing(place, capsys)


def test_without_any_folder_functions_are_compiled_each_time():
    told = (
        "import os, tempfile; os.access = lambda *_: False; tempfile.tempdir = '/nowhere/at/all'\n"
        "import models, numba, librosa.util\n"
        "twice = numba.njit('f8(f8)', cache=True)(lambda x: 2.0 * x)\n"
        "print(twice(1.5), type(twice._cache).__name__)"
    )
    done = subprocess.run([sys.executable, "-c", told], capture_output=True, text=True, cwd=ROOT)
    assert done.stdout == "3.0 NullCache\n", done.stderr
    assert done.stderr.startswith("bushing-noise: note: there is no safe folder")


@pytest.mark.slow
@pytest.mark.parametrize(
    "call",
    [
        ["-m", "noise", "simulate", "--speed", "5", "--seconds", "0.1", "--out", "run"],
        ["-c", "import noise; noise.simulate(noise.load_material_rig('PDMS'), 5.0, seconds=0.1)"],
    ],
)
def test_a_read_only_installation_without_a_home(tmp_path, call):
    """All of it for real: a copy of the program on a read-only mount, and a home that is none."""
    site = tmp_path / "site"
    packages = " ".join(str(ROOT / name) for name in ("models", "sim", "features", "noise"))
    (tmp_path / "work").mkdir()
    script = (
        f"mkdir {site} && cp -r {packages} {site} && cd {site} && "
        "find . -name __pycache__ -exec rm -r {} + && "
        f"mount --bind {site} {site} && mount -o remount,ro,bind {site} && cd {tmp_path / 'work'} "
        '&& exec "$@"'
    )
    user = ["env", "-i", f"HOME={site}", f"PYTHONPATH={site}", f"TMPDIR={tmp_path}"]
    isolated = ["unshare", "--map-root-user", "--mount", "sh", "-ec", script, "sh"]
    probe = ["unshare", "--map-root-user", "--mount", "sh", "-c", "mount --bind /tmp /tmp"]
    try:
        subprocess.run(probe, check=True, capture_output=True)
    except (OSError, subprocess.CalledProcessError):
        pytest.skip("no mounts of one's own here")
    done = subprocess.run([*isolated, *user, sys.executable, *call], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert list(tmp_path.glob("bushing-noise-*/solvers_*/*.nbc"))

"""The package as a notebook meets it."""

import os
import subprocess
import sys

import pytest

import noise


def imported(tmp_path, code="import noise"):
    environment = {**os.environ, "PYTHONPATH": str(tmp_path)}
    return subprocess.run(
        [sys.executable, "-c", code],
        cwd=tmp_path,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.mark.parametrize("name", ["models", "sim", "features"])
def test_a_users_file_that_hides_a_package_is_named(tmp_path, name):
    (tmp_path / f"{name}.py").write_text("x = 1\n", encoding="utf-8")
    result = imported(tmp_path)
    assert result.returncode != 0
    last = result.stderr.strip().splitlines()[-1]
    assert f"{name}.py hides the package {name!r}" in last
    assert "rename it" in last


def test_a_users_folder_that_hides_a_package_is_named(tmp_path):
    (tmp_path / "features").mkdir()
    (tmp_path / "features" / "__init__.py").write_text("", encoding="utf-8")
    assert "hides the package 'features'" in imported(tmp_path).stderr


def test_other_files_of_the_user_do_not_matter(tmp_path):
    (tmp_path / "model.py").write_text("x = 1\n", encoding="utf-8")
    assert imported(tmp_path).returncode == 0


def test_import_is_light(tmp_path):
    heavy = "{'numpy', 'scipy', 'sklearn', 'librosa', 'matplotlib', 'numba'}"
    code = f"import noise, sys; assert not {heavy} & set(sys.modules)"
    assert imported(tmp_path, code).returncode == 0


def test_a_name_that_is_not_there_is_an_attribute_error():
    with pytest.raises(AttributeError, match="nonsense"):
        _ = noise.nonsense

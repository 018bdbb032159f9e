from __future__ import annotations

import errno
import os
from typing import TYPE_CHECKING

import pytest

from models.errors import ParameterError
from noise.base.files import atomic, check_target

if TYPE_CHECKING:
    from pathlib import Path


def write_half_and_raise(target: Path, error: BaseException) -> None:
    with atomic(target) as path:
        path.write_text("ha")
        raise error


@pytest.mark.parametrize("interruption", [RuntimeError, KeyboardInterrupt])
def test_an_interrupted_write_leaves_the_old_file(tmp_path, interruption):
    target = tmp_path / "table.csv"
    target.write_text("old")
    with pytest.raises(interruption):
        write_half_and_raise(target, interruption())
    assert target.read_text() == "old"
    assert list(tmp_path.iterdir()) == [target]


def test_a_full_disk_is_an_error_in_one_line(tmp_path):
    target = tmp_path / "table.csv"
    message = r"table\.csv: cannot be written \(No space left on device\)"
    with pytest.raises(ParameterError, match=message):
        write_half_and_raise(target, OSError(errno.ENOSPC, "No space left on device"))
    assert list(tmp_path.iterdir()) == []


def test_of_a_link_what_it_leads_to_is_written_and_the_link_stays(tmp_path):
    (tmp_path / "share").mkdir()
    (tmp_path / "share" / "labels.csv").write_text("old")
    for name in ("labels.csv", "new.csv"):
        link = tmp_path / name
        link.symlink_to(tmp_path / "share" / name)
        with atomic(link) as path:
            assert path.parent == tmp_path / "share"
            path.write_text("new")
        assert link.is_symlink()
        assert (tmp_path / "share" / name).read_text() == "new"
    assert sorted(one.name for one in (tmp_path / "share").iterdir()) == ["labels.csv", "new.csv"]


def test_a_link_in_a_circle_and_a_pipe_are_no_files_to_write(tmp_path):
    (tmp_path / "a.csv").symlink_to(tmp_path / "a.csv")
    os.mkfifo(tmp_path / "b.csv")
    for name, reason in (("a.csv", "leads nowhere"), ("b.csv", "is a pipe or a device")):
        with pytest.raises(ParameterError, match=reason), atomic(tmp_path / name) as path:
            path.write_text("new")
        with pytest.raises(ParameterError, match=f"^--out .*{name}: .*{reason}"):
            check_target(tmp_path / name)

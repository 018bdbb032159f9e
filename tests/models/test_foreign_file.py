"""The gate for files from outside: what is no file, what is too large, and what libraries raise."""

from __future__ import annotations

import io
import struct
import zipfile
import zlib
from tokenize import TokenError

import numpy as np
import pytest

from models.errors import ParameterError, RecordingError
from models.foreign_file import read_arrays, reading, refusing


def refusal(path, read=read_arrays, what="NPZ file"):
    with pytest.raises(ParameterError) as refused, reading(path, what):
        read(path)
    message = str(refused.value)
    assert message.startswith(f"{path}: ")
    assert "\n" not in message
    return message.removeprefix(f"{path}: ")


def test_a_file_that_is_too_large_is_not_opened(tmp_path):
    path = tmp_path / "rig.toml"
    with path.open("wb") as file:
        file.truncate(3_000_000)
    with (
        pytest.raises(ParameterError, match="has 3 MB, and 1 MB are the most"),
        reading(path, "TOML file", largest=1_000_000),
    ):
        raise AssertionError


@pytest.mark.parametrize(
    "raised",
    [
        TokenError("EOF in multi-line statement", (2, 0)), zlib.error("invalid block type"),
        zipfile.BadZipFile("Bad magic number"), NotImplementedError("strong encryption"),
        RecursionError("maximum"), MemoryError(), EOFError(), KeyError("header"),
        struct.error("unpack requires"), ValueError("first line\n  second line\n"),
        RuntimeError("password required"), OverflowError("int too large"), AssertionError(),
        UnicodeDecodeError("utf-8", b"\xff", 0, 1, "invalid start byte"), OSError("no errno"),
        ValueError("long " * 1000),
    ],
)  # fmt: skip
def test_whatever_a_library_raises_is_one_line_that_names_the_file(raised):
    with pytest.raises(RecordingError) as refused, refusing("run.h5", "recording", RecordingError):
        raise raised
    message = str(refused.value)
    assert message.startswith("run.h5: ")
    assert "\n" not in message
    assert len(message) < 300


def npz(path, members, compression=zipfile.ZIP_DEFLATED):
    with zipfile.ZipFile(path, "w", compression) as archive:
        for name, content in members.items():
            archive.writestr(name, content)
    return path


def npy(array):
    file = io.BytesIO()
    np.save(file, array)
    return file.getvalue()


def test_a_file_that_inflates_beyond_measure_is_refused_before_it_does(tmp_path):
    path = tmp_path / "bomb.npz"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for i in range(5):
            with archive.open(f"{i}.npy", "w") as member:
                for _ in range(20):
                    member.write(bytes(1 << 20))
    assert path.stat().st_size < 200_000
    assert refusal(path).startswith("would inflate from 0.102 MB to 105 MB")


@pytest.mark.parametrize("members", [
    {"x.npy": b""}, {"x.npy": b"no magic at all, but long enough for one"}, {"readme.txt": b"hi"},
    {"x.npy": npy(np.zeros(9))[:-5]}, {"x.npy": npy(np.zeros(9)).replace(b"(9,)", b"(9, ")},
    {"x.npy": npy(np.zeros(9)).replace(b"<f8", b"|O8")},
])  # fmt: skip
def test_a_member_that_is_no_array_is_refused(tmp_path, members):
    assert "damaged" in refusal(npz(tmp_path / "a.npz", members)) or members

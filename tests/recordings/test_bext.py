from __future__ import annotations

import io
import struct

import pytest
from hypothesis import given, strategies as st

from noise.recordings import read_recording
from noise.recordings.formats.containers import bext_description, chunks

FMT = b"fmt " + struct.pack("<IHHIIHH", 16, 1, 1, 48_000, 48_000, 1, 8)


def chunk(name: bytes, content: bytes, size: int | None = None) -> bytes:
    length = len(content) if size is None else size
    return name + struct.pack("<I", length) + content + b"\0" * (len(content) % 2)


def riff(*parts: bytes, head: bytes = b"RIFF") -> bytes:
    body = b"WAVE" + b"".join(parts)
    return head + struct.pack("<I", len(body)) + body


@pytest.mark.parametrize("tag", [b"RIFF", b"RF64", b"BW64"])
@pytest.mark.parametrize("pad", [b"", b"\0", b"\x41"])
def test_a_description_after_an_odd_number_of_bytes_is_found_padded_or_not(tmp_path, tag, pad):
    text = chunk(b"bext", b"Sound: 0dBFS = 109.7 dBSPL".ljust(602, b"\0"))
    odd = b"data" + struct.pack("<I", 4801) + b"\x11" * 4801 + pad
    path = tmp_path / "run.wav"
    path.write_bytes(riff(FMT, odd, text, head=tag))
    assert bext_description(path) == "Sound: 0dBFS = 109.7 dBSPL"
    calibrated = read_recording(path)
    assert calibrated.calibrated
    assert calibrated.channels[0].full_scale == pytest.approx(20e-6 * 10 ** (109.7 / 20))


@given(st.sampled_from([b"RIFF", b"RIFX", b"RF64", b"FORM", b"fLaC", b""]), st.binary(max_size=300))
def test_any_bytes_end_the_walk(head, rest):
    found = list(chunks(io.BytesIO(head + rest)))
    assert all(part.start <= 4 + len(rest) for part in found)


@given(st.binary(min_size=1, max_size=40))
def test_any_description_is_text(tmp_path_factory, content):
    path = tmp_path_factory.mktemp("bext") / "run.wav"
    path.write_bytes(riff(chunk(b"bext", content)))
    assert bext_description(path).encode("latin-1") in content

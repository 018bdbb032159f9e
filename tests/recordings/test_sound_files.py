"""Sound files read to their end, whatever their header says of it, or refused for what is there."""

from __future__ import annotations

import io
import struct
from contextlib import suppress
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest
import soundfile
from hypothesis import given, strategies as st

from models.errors import RecordingError
from noise.recordings import read_recording
from noise.recordings.formats.sound_file import open_sound_file

RATE = 48_000
SECONDS = 3


def tone(start=2.0, end=2.5, rate=RATE, n_tracks=1):
    """Silence with a tone of 1000 Hz between two times."""
    t = np.arange(SECONDS * rate) / rate
    x = 0.3 * np.sin(2 * np.pi * 1000 * t) * ((t >= start) & (t < end))
    return np.stack([x] * n_tracks, axis=1)


def encoded(samples, rate=RATE, **how):
    file = io.BytesIO()
    soundfile.write(file, samples, rate, **how)
    return file.getvalue()


def read(tmp_path, data, ending="wav"):
    path = tmp_path / f"run.{ending}"
    path.write_bytes(data)
    with open_sound_file(path) as raw:
        return SimpleNamespace(**vars(raw), samples=raw.whole())


def assert_tones(raw, *expected):
    """Compare the times between which there is a tone [s]."""
    at = np.flatnonzero(np.abs(raw.samples[0]) > 0.03) / raw.rate
    gaps = [0, *(i + 1 for i, (a, b) in enumerate(pairwise(at)) if b - a > 0.08), len(at)]
    found = [(at[a], at[b - 1]) for a, b in pairwise(gaps)]
    delay = 1.5e3 / raw.rate  # of an encoder, which a header would state
    assert np.array(found) == pytest.approx(np.array(expected), abs=0.03 + delay)


# Files as the library writes them

FORMATS = [
    ("wav", "FLOAT", False),
    ("wav", "PCM_16", True),
    ("flac", "PCM_16", True),
    ("rf64", "DOUBLE", False),
    ("ogg", "VORBIS", True),
    ("mp3", "MPEG_LAYER_III", True),
]


@pytest.mark.parametrize(("ending", "subtype", "fractional"), FORMATS)
def test_a_whole_file_gives_its_samples_and_one_that_is_cut_is_refused(
    tmp_path, ending, subtype, fractional
):
    t = np.arange(150_000)[:, None] / RATE
    data = encoded(
        0.5 * np.sin(2 * np.pi * 500 * t + np.arange(2)), format=ending.upper(), subtype=subtype
    )
    raw = read(tmp_path, data, ending)
    assert (raw.rate, raw.fractional, raw.notes) == (RATE, fractional, ())
    assert np.array_equal(raw.samples, soundfile.read(io.BytesIO(data), always_2d=True)[0].T)
    for share in (0.5, 0.9):
        try:
            cut = read(tmp_path, data[: int(share * len(data))], ending)
        except RecordingError as error:
            assert str(tmp_path) in str(error)  # noqa: PT017
        else:  # without a length in its header, a shorter stream of OGG is a stream of OGG
            assert ending == "ogg"
            assert cut.samples.shape[1] < len(t)


# MP3

HIGH = (0, 32, 40, 48, 56, 64, 80, 96, 112, 128, 160, 192, 224, 256, 320)
LOW = (0, 8, 16, 24, 32, 40, 48, 56, 64, 80, 96, 112, 128, 144, 160)


def mp3(mode, rate=44100, n_tracks=1, **when):
    how = {"bitrate_mode": mode, "compression_level": 0.5}
    samples = tone(rate=rate, n_tracks=n_tracks, **when)
    return encoded(samples, rate, format="MP3", subtype="MPEG_LAYER_III", **how)


def headless(data):
    """Take away the first frame, in which the length stands."""
    bits = int.from_bytes(data[:4], "big")
    low = bits >> 19 & 3 != 3
    rate = (44100, 48000, 32000)[bits >> 10 & 3] >> {3: 0, 2: 1, 0: 2}[bits >> 19 & 3]
    kbit = (LOW if low else HIGH)[bits >> 12 & 15]
    size = (72 if low else 144) * kbit * 1000 // rate + (bits >> 9 & 1)
    assert data[size : size + 1] == b"\xff"
    return data[size:]


@pytest.mark.parametrize(
    ("mode", "rate", "n_tracks"), [("VARIABLE", 48000, 1), ("CONSTANT", 44100, 2)]
)
def test_an_mp3_without_a_header_is_read_to_its_end(tmp_path, mode, rate, n_tracks):
    raw = read(tmp_path, headless(mp3(mode, rate, n_tracks)), "mp3")
    assert raw.samples.shape[0] == n_tracks
    assert raw.samples.shape[1] / raw.rate == pytest.approx(SECONDS, abs=0.2)
    assert_tones(raw, (2.0, 2.5))


ID3V2 = b"ID3\x04\0\0\0\0\x02\x01" + b"\xff\xfb\x90\x64" * 64 + b"\0"
ID3V1 = b"TAG" + b"t" * 125
APE = b"APETAGEX" + struct.pack("<IIII", 2000, 40, 1, 0) + bytes(8) + bytes(40)


@pytest.mark.parametrize(("before", "after"), [(ID3V2, ID3V1), (b"", APE + ID3V1)])
def test_tags_around_an_mp3_are_no_sound(tmp_path, before, after):
    for data in (mp3("VARIABLE"), headless(mp3("CONSTANT"))):
        bare = read(tmp_path, data, "mp3").samples
        assert np.array_equal(read(tmp_path, before + data + after, "mp3").samples, bare)


@pytest.mark.parametrize("first", [bytes, headless])
def test_of_an_mp3_with_a_header_cut_off_is_refused_and_without_it_read(tmp_path, first):
    data = first(mp3("VARIABLE"))
    cut = data[: len(data) * 9 // 10]
    if first is headless:
        assert_tones(read(tmp_path, cut, "mp3"), (2.0, 2.5))
    else:
        with pytest.raises(RecordingError, match=r"truncated; its header announces 13\d+ samples"):
            read(tmp_path, cut, "mp3")


# Ogg and FLAC


def parts(*starts, **how):
    return [encoded(tone(at, at + 0.5), **how) for at in starts]


def test_several_sounds_in_a_file_are_refused(tmp_path):
    joined = {
        "ogg": parts(2.0, 1.0, format="OGG", subtype="VORBIS"),
        "opus": parts(2.0, 1.0, format="OGG", subtype="OPUS"),
        "flac": parts(2.0, 1.0, format="FLAC"),
        "wav": parts(2.0, 1.0, format="WAV"),
        "mp3": (mp3("VARIABLE"), ID3V1 + ID3V2 + mp3("VARIABLE")),
    }
    for ending, (one, other) in joined.items():
        with pytest.raises(RecordingError, match=r"a second sound begins at byte \d+"):
            read(tmp_path, one + other, ending)


# WAV


def chunk(name, content, size=None):
    length = len(content) if size is None else size
    return name + struct.pack("<I", length) + content + b"\0" * (len(content) % 2)


def riff(*parts, size=None, tag=b"RIFF"):
    body = b"WAVE" + b"".join(parts)
    return tag + struct.pack("<I", len(body) if size is None else size) + body


def fmt(bits, *, code=1, extensible=False):
    frame, kind = bits // 8, 0xFFFE if extensible else code
    content = struct.pack("<HHIIHH", kind, 1, RATE, frame * RATE, frame, bits)
    if extensible:
        rest = bytes.fromhex("000000001000800000aa00389b71")
        content += struct.pack("<HHIH", 22, bits, 4, code) + rest
    return chunk(b"fmt ", content)


X = tone(1.0)[:, 0]
AS_16 = np.round(X * 32767).astype("<i2").tobytes()
AS_FLOAT = X.astype("<f4").tobytes()
KINDS = {"16 bits": (fmt(16), AS_16), "float": (fmt(32, code=3), AS_FLOAT)}
LONG = 0xFFFFFFFF
HEAD = fmt(16)


def assert_sound(raw, expected=X):
    np.testing.assert_allclose(raw.samples, expected[np.newaxis], atol=1e-4)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(
    ("size", "whole"),
    [(0, 0), (0, 36), (LONG, LONG), (0x7FFFFFFF, 8), (0x80000000, None), (0x7FFFF000, 0)],
)
def test_a_wav_whose_recorder_died_is_read_to_its_end(tmp_path, kind, size, whole):
    head, data = KINDS[kind]
    raw = read(tmp_path, riff(head, chunk(b"data", data, size), size=whole))
    assert_sound(raw)
    note = f"the recorder did not finish the header; the {len(data)} bytes that follow it are read"
    assert raw.notes == (note,)


def ds64(n, samples=0):
    return chunk(b"ds64", struct.pack("<QQQI", n and n + 72, n, samples, 0))


@pytest.mark.parametrize("kind", KINDS)
def test_a_file_of_64_bit_sizes_is_read_and_one_without_them_refused(tmp_path, kind):
    head, data = KINDS[kind]
    parts = head, chunk(b"data", data, LONG)
    raw = read(tmp_path, riff(ds64(len(data), len(X)), *parts, size=LONG, tag=b"RF64"))
    assert_sound(raw)
    assert raw.notes == ()
    with pytest.raises(RecordingError, match="is truncated"):
        read(tmp_path, riff(ds64(0), *parts, size=LONG, tag=b"RF64"))


@pytest.mark.parametrize("tag", [b"RIFF", b"RF64"])
def test_what_follows_the_samples_is_none_of_them_and_named_where_it_is_no_chunk(tmp_path, tag):
    sizes, size = (b"", len(AS_16)) if tag == b"RIFF" else (ds64(len(AS_16)), LONG)
    data = chunk(b"data", AS_16, size)
    raw = read(tmp_path, riff(sizes, HEAD, data, chunk(b"LIST", b"\x55" * 4001), tag=tag))
    assert raw.samples.shape == (1, len(X))
    assert raw.notes == ()
    sizes, size = (b"", 2000) if tag == b"RIFF" else (ds64(2000), LONG)
    raw = read(tmp_path, riff(sizes, HEAD, chunk(b"data", AS_16, size), tag=tag))
    assert raw.samples.shape == (1, 1000)
    rest = len(AS_16) - 2000
    assert raw.notes == (f"{rest} bytes after the end that the header states are not read",)


# The description of Broadcast Wave files


@pytest.mark.parametrize("tag", [b"RIFF", b"RF64"])
def test_a_description_after_an_odd_number_of_bytes_is_found(tmp_path, tag):
    text = chunk(b"bext", b"Sound: 0dBFS = 109.7 dBSPL".ljust(602, b"\0"))
    odd = b"data" + struct.pack("<I", 4801) + b"\x11" * 4801 + b"\0"
    path = tmp_path / "run.wav"
    path.write_bytes(riff(fmt(8), odd, text, tag=tag))
    calibrated = read_recording(path)
    assert calibrated.channels[0].full_scale == pytest.approx(20e-6 * 10 ** (109.7 / 20))


@given(st.sampled_from([b"RIFF", b"RIFX", b"RF64", b"FORM", b"fLaC", b""]), st.binary(max_size=300))
def test_any_bytes_are_refused_or_empty(tmp_path_factory, head, rest):
    with suppress(RecordingError):
        assert read(tmp_path_factory.mktemp("any"), head + rest + b"\0").samples.size < 400

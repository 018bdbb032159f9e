"""Sounds whose header is wrong about their length, or says nothing of it, as the world has them."""

from __future__ import annotations

import io
import struct
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest
import soundfile

from models.errors import RecordingError
from noise.recordings.formats.containers import pieces_of
from noise.recordings.formats.sound_file import open_sound_file

RATE = 48_000
SECONDS = 3


def tone(start: float = 2.0, end: float = 2.5, rate: int = RATE, n_tracks: int = 1) -> np.ndarray:
    """Silence with a tone of 1000 Hz between two times."""
    t = np.arange(SECONDS * rate) / rate
    x = 0.3 * np.sin(2 * np.pi * 1000 * t) * ((t >= start) & (t < end))
    return np.stack([x] * n_tracks, axis=1)


def encoded(samples: np.ndarray, rate: int = RATE, **how: object) -> bytes:
    file = io.BytesIO()
    soundfile.write(file, samples, rate, **how)
    return file.getvalue()


def mp3(mode: str, rate: int = 44100, n_tracks: int = 1, **when: float) -> bytes:
    return encoded(
        tone(rate=rate, n_tracks=n_tracks, **when), rate,
        format="MP3", subtype="MPEG_LAYER_III", bitrate_mode=mode, compression_level=0.5,
    )  # fmt: skip


def headless(data: bytes) -> bytes:
    """Take away the first frame, in which the length stands."""
    bits = int.from_bytes(data[:4], "big")
    low = bits >> 19 & 3 != 3
    rate = (44100, 48000, 32000)[bits >> 10 & 3] >> {3: 0, 2: 1, 0: 2}[bits >> 19 & 3]
    high = (0, 32, 40, 48, 56, 64, 80, 96, 112, 128, 160, 192, 224, 256, 320)
    kbit = (0, 8, 16, 24, 32, 40, 48, 56, 64, 80, 96, 112, 128, 144, 160) if low else high
    size = (72 if low else 144) * kbit[bits >> 12 & 15] * 1000 // rate + (bits >> 9 & 1)
    assert data[size : size + 1] == b"\xff"
    return data[size:]


def read_sound_file(path):
    with open_sound_file(path) as raw:
        return SimpleNamespace(**vars(raw), samples=raw.whole())


def read(tmp_path, data: bytes, ending: str = "wav"):
    path = tmp_path / f"run.{ending}"
    path.write_bytes(data)
    return read_sound_file(path)


def sounding(raw, by: float = 0.08) -> list[tuple[float, float]]:
    """Return between which times there is a tone [s]."""
    loud = np.abs(raw.samples[0]) > 0.03
    at = np.flatnonzero(loud) / raw.rate
    gaps = [0, *(i + 1 for i, (a, b) in enumerate(pairwise(at)) if b - a > by), len(at)]
    return [(at[a], at[b - 1]) for a, b in pairwise(gaps)]


def assert_tones(raw, *expected: tuple[float, float]) -> None:
    delay = 1.5e3 / raw.rate  # of an encoder, which a header would state
    assert np.array(sounding(raw)) == pytest.approx(np.array(expected), abs=0.03 + delay)


# MP3


@pytest.mark.parametrize("n_tracks", [1, 2])
@pytest.mark.parametrize("rate", [48000, 44100, 32000, 22050, 16000, 8000])
@pytest.mark.parametrize("mode", ["VARIABLE", "CONSTANT", "AVERAGE"])
def test_an_mp3_without_a_header_is_read_to_its_end(tmp_path, mode, rate, n_tracks):
    raw = read(tmp_path, headless(mp3(mode, rate, n_tracks)), "mp3")
    assert raw.samples.shape[0] == n_tracks
    assert raw.samples.shape[1] / raw.rate == pytest.approx(SECONDS, abs=0.15)
    assert_tones(raw, (2.0, 2.5))


def test_all_frames_of_an_mp3_without_a_header_are_read(tmp_path):
    data = headless(mp3("CONSTANT"))
    frames = round(len(data) * 44100 / (144 * 160_000))  # of 160 kbit/s
    n = read(tmp_path, data, "mp3").samples.shape[1]
    assert n == frames * 1152 - 529  # which is the delay of the decoder


ID3V2 = b"ID3\x04\0\0\0\0\x02\x01" + b"\xff\xfb\x90\x64" * 64 + b"\0"
ID3V1 = b"TAG" + b"t" * 125
APE = b"APETAGEX" + struct.pack("<IIII", 2000, 40, 1, 0) + bytes(8) + bytes(40)


@pytest.mark.parametrize("mode", ["VARIABLE", "CONSTANT"])
@pytest.mark.parametrize(
    ("before", "after"),
    [(ID3V2, b""), (b"", ID3V1), (ID3V2, ID3V1), (b"", APE + ID3V1), (b"\0" * 777, b"\0" * 100)],
)
def test_tags_around_an_mp3_are_no_sound(tmp_path, mode, before, after):
    plain = mp3(mode)
    for data in (plain, headless(plain)):
        bare = read(tmp_path, data, "mp3").samples
        assert np.array_equal(read(tmp_path, before + data + after, "mp3").samples, bare)


@pytest.mark.parametrize("between", [b"", ID3V2, ID3V1, ID3V1 + ID3V2])
@pytest.mark.parametrize("first", ["with", "without"])
@pytest.mark.parametrize("second", ["with", "without"])
def test_of_joined_mp3_both_are_read(tmp_path, first, second, between):
    one, other = mp3("VARIABLE"), mp3("VARIABLE", start=0.5, end=1.0)
    one = one if first == "with" else headless(one)
    other = other if second == "with" else headless(other)
    raw = read(tmp_path, one + between + other, "mp3")
    assert raw.samples.shape[1] / raw.rate == pytest.approx(2 * SECONDS, abs=0.15)
    assert_tones(raw, (2.0, 2.5), (3.5, 4.0))


def test_an_mp3_with_a_header_is_read_as_ever(tmp_path):
    for mode in ("VARIABLE", "CONSTANT", "AVERAGE"):
        data = mp3(mode, n_tracks=2)
        expected = soundfile.read(io.BytesIO(data), always_2d=True)[0]
        assert len(expected) == SECONDS * 44100
        assert np.array_equal(read(tmp_path, data, "mp3").samples, expected.T)


def test_an_mp3_that_is_cut_off_is_refused_where_it_has_a_header(tmp_path):
    data = mp3("VARIABLE")
    with pytest.raises(RecordingError, match=r"truncated; its header announces 1\d\d frames, \d+"):
        read(tmp_path, data[: len(data) * 2 // 3], "mp3")
    raw = read(tmp_path, headless(data)[:-2000], "mp3")
    assert_tones(raw, (2.0, 2.5))


def test_text_and_noise_are_no_mp3(tmp_path):
    noise = np.random.default_rng(1).bytes(100_000)
    many = (
        b"\xff" * 20_000_000,
        b"\xff\xfb\x90\x00\x01" * 2_000_000,
    )  # no frames
    for data in (noise, b"a diary\n" * 500, *many, b"ID3", b"\xff\xfb\x90\x64"):
        with pytest.raises(RecordingError, match="no sound file"):
            read(tmp_path, data, "mp3")


# Ogg and FLAC


@pytest.mark.parametrize("subtype", ["VORBIS", "OPUS"])
@pytest.mark.parametrize("n_tracks", [1, 2])
def test_of_joined_ogg_all_are_read(tmp_path, subtype, n_tracks):
    parts = [
        encoded(tone(at, at + 0.5, n_tracks=n_tracks), format="OGG", subtype=subtype)
        for at in (2.0, 1.0, 0.5)
    ]
    raw = read(tmp_path, b"".join(parts), "opus" if subtype == "OPUS" else "ogg")
    assert raw.samples.shape == (n_tracks, 3 * SECONDS * RATE)
    assert_tones(raw, (2.0, 2.5), (4.0, 4.5), (6.5, 7.0))
    assert raw.notes == ("3 sounds one after the other in one file are read as one",)


def test_sounds_of_other_rates_in_one_file_are_refused(tmp_path):
    parts = [encoded(tone(rate=r), r, format="OGG", subtype="VORBIS") for r in (48000, 44100)]
    with pytest.raises(RecordingError, match="of 1 tracks at 48000 Hz and of 1 at 44100 Hz"):
        read(tmp_path, b"".join(parts), "ogg")


def test_parts_of_joined_sounds_are_those_of_the_whole(tmp_path):
    joined = {
        "ogg": b"".join(encoded(tone(a), format="OGG", subtype="VORBIS") for a in (0, 2)),
        "mp3": headless(mp3("VARIABLE")) + mp3("VARIABLE"),
        "flac": encoded(tone(), format="FLAC") + encoded(tone(1.0), format="FLAC"),
    }
    for ending, data in joined.items():
        whole = read(tmp_path, data, ending).samples
        with open_sound_file(tmp_path / f"run.{ending}") as sound:
            n = sound.n_samples
            assert n == whole.shape[1]
            for first, last in [(0, 10), (n // 2 - 9000, n // 2 + 9000), (100, 7000), (n - 9, n)]:
                assert np.array_equal(sound.read(first, last), whole[:, first:last])


def open_length(flac: bytes) -> bytes:
    content = bytearray(flac)
    content[21] &= 0xF0  # the 36 bits that count the samples
    content[22:26] = bytes(4)
    return bytes(content)


@pytest.mark.parametrize("subtype", ["PCM_16", "PCM_24"])
@pytest.mark.parametrize("n_tracks", [1, 2])
def test_a_flac_of_unknown_length_is_read_to_its_end(tmp_path, subtype, n_tracks):
    data = encoded(tone(n_tracks=n_tracks), format="FLAC", subtype=subtype)
    raw = read(tmp_path, open_length(data), "flac")
    assert np.array_equal(raw.samples, read(tmp_path, data, "flac").samples)


def test_a_flac_of_unknown_length_that_breaks_off_says_what_there_is(tmp_path):
    data = open_length(encoded(tone(0, 3), format="FLAC"))
    with pytest.raises(RecordingError, match=r"does not say how long it is, and breaks off after"):
        read(tmp_path, data[: len(data) * 2 // 3], "flac")


def test_of_joined_flac_both_are_read(tmp_path):
    one, other = (encoded(tone(at, at + 0.5), format="FLAC") for at in (2.0, 1.0))
    raw = read(tmp_path, one + open_length(other), "flac")
    assert raw.samples.shape[1] == 2 * SECONDS * RATE
    assert_tones(raw, (2.0, 2.5), (4.0, 4.5))


# WAV


def chunk(name: bytes, content: bytes, size: int | None = None) -> bytes:
    length = len(content) if size is None else size
    return name + struct.pack("<I", length) + content + b"\0" * (len(content) % 2)


def riff(*parts: bytes, size: int | None = None, tag: bytes = b"RIFF") -> bytes:
    body = b"WAVE" + b"".join(parts)
    return tag + struct.pack("<I", len(body) if size is None else size) + body


def fmt(bits: int, *, code: int = 1, extensible: bool = False) -> bytes:
    frame = bits // 8
    kind = 0xFFFE if extensible else code
    content = struct.pack("<HHIIHH", kind, 1, RATE, frame * RATE, frame, bits)
    if extensible:
        rest = bytes.fromhex("000000001000800000aa00389b71")
        content += struct.pack("<HHIH", 22, bits, 4, code) + rest
    return chunk(b"fmt ", content)


KINDS = {
    "16 bits": (fmt(16), "<i2"),
    "24 bits": (fmt(24), "i3"),
    "32 bits": (fmt(32), "<i4"),
    "float": (fmt(32, code=3), "<f4"),
    "extensible": (fmt(16, extensible=True), "<i2"),
    "extensible float": (fmt(32, code=3, extensible=True), "<f4"),
}
X = tone(1.0)[:, 0]


def assert_sound(raw, expected: np.ndarray) -> None:
    np.testing.assert_allclose(raw.samples, expected[np.newaxis], atol=1e-4)


def data_of(kind: str) -> tuple[bytes, bytes]:
    head, code = KINDS[kind]
    if code == "<f4":
        return head, X.astype("<f4").tobytes()
    bits = 8 * int(code[-1])
    whole = np.round(X * (2 ** (bits - 1) - 1)).astype("<i4")
    if code == "i3":
        return head, whole.view("u1").reshape(-1, 4)[:, :3].tobytes()
    return head, whole.astype(code).tobytes()


UNFINISHED = [0, 0xFFFFFFFF, 0x7FFFFFFF, 0x80000000, 0x7FFFF000]


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("size", UNFINISHED)
@pytest.mark.parametrize("whole", [0, 8, 36, 0xFFFFFFFF, None])
def test_a_wav_whose_recorder_died_is_read_to_its_end(tmp_path, kind, size, whole):
    head, data = data_of(kind)
    raw = read(tmp_path, riff(head, chunk(b"data", data, size), size=whole))
    assert_sound(raw, X)
    note = f"the recorder did not finish the header; the {len(data)} bytes that follow it are read"
    assert raw.notes == (note,)


def test_the_last_sample_of_a_recorder_that_died_may_be_half_there(tmp_path):
    head, data = data_of("16 bits")
    raw = read(tmp_path, riff(head, chunk(b"data", data, 0))[:-3])
    assert_sound(raw, X[:-2])


def test_an_empty_recording_is_one_whatever_chunks_follow(tmp_path):
    for rest in (b"", chunk(b"LIST", b"INFOISFT\4\0\0\0rec\0"), chunk(b"bext", bytes(602))):
        raw = read(tmp_path, riff(fmt(16), chunk(b"data", b""), rest))
        assert raw.samples.shape == (1, 0)


def ds64(n: int | None, samples: int = 0) -> bytes:
    if n is None:
        return chunk(b"ds64", b"\xff" * 24 + bytes(4))
    return chunk(b"ds64", struct.pack("<QQQI", n and n + 72, n, samples, 0))


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("tag", [b"RF64", b"BW64"])
@pytest.mark.parametrize("finished", [True, 0, None])
def test_files_of_64_bit_sizes_are_read_whatever_stands_there(tmp_path, kind, tag, finished):
    head, data = data_of(kind)
    sizes = ds64(len(data), len(X)) if finished is True else ds64(finished)
    content = riff(sizes, head, chunk(b"data", data, 0xFFFFFFFF), size=0xFFFFFFFF, tag=tag)
    raw = read(tmp_path, content)
    assert_sound(raw, X)
    assert bool(raw.notes) is (finished is not True)


@pytest.mark.parametrize("tag", [b"RIFF", b"RF64", b"BW64"])
def test_what_follows_the_samples_is_none_of_them(tmp_path, tag):
    head, data = data_of("16 bits")
    sizes = b"" if tag == b"RIFF" else ds64(len(data))
    size = len(data) if tag == b"RIFF" else 0xFFFFFFFF
    after = chunk(b"LIST", b"\x55" * 4001)
    raw = read(tmp_path, riff(sizes, head, chunk(b"data", data, size), after, tag=tag))
    assert raw.samples.shape == (1, len(X))
    assert raw.notes == ()


def test_an_odd_chunk_before_the_samples_may_lack_its_last_byte(tmp_path):
    head, data = data_of("16 bits")
    odd = b"LIST" + struct.pack("<I", 3) + b"abc"
    raw = read(tmp_path, riff(head, odd, chunk(b"data", data)))
    assert_sound(raw, X)


@pytest.mark.parametrize("tag", [b"RIFF", b"RF64"])
def test_bytes_beyond_the_end_that_is_stated_are_named(tmp_path, tag):
    head, data = data_of("16 bits")
    sizes = b"" if tag == b"RIFF" else ds64(2000)
    size = 2000 if tag == b"RIFF" else 0xFFFFFFFF
    content = riff(sizes, head, b"data" + struct.pack("<I", size) + data, tag=tag)
    raw = read(tmp_path, content)
    assert raw.samples.shape == (1, 1000)
    assert raw.notes == (
        f"{len(data) - 2000} bytes after the end that the header states are not read",
    )


def test_a_second_wav_in_a_file_is_refused(tmp_path):
    data = encoded(tone(), format="WAV")
    with pytest.raises(RecordingError, match=f"a second WAV file begins at byte {len(data)}"):
        read(tmp_path, data + data)


@pytest.mark.parametrize("ending", ["wav", "flac", "aiff", "ogg", "mp3", "rf64"])
def test_what_is_whole_goes_to_the_library_as_it_is(tmp_path, ending):
    path = tmp_path / f"run.{ending}"
    soundfile.write(path, tone(), RATE, format=ending.upper())
    pieces, notes = pieces_of(path)
    assert notes == []
    assert len(pieces) == 1
    assert pieces[0].end == path.stat().st_size
    assert ending == "mp3" or pieces[0].head == b""

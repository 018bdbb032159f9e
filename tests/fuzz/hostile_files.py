"""Files that are whole and hostile: rates, shapes, types and ratios of inflation that none has.

Each function takes a valid file and a generator, and gives the content of a hostile one.
"""

from __future__ import annotations

import io
import struct
import zipfile
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from tests.fuzz.mutations import BYTES, TEXT, pick

if TYPE_CHECKING:
    from tests.fuzz.mutations import Rng

__all__ = ["hdf5", "mdf", "npy", "npz", "parquet", "tdms", "uff", "wav", "workbook"]

RATES = (
    0.0, -1.0, 1e-6, 1e-300, 0.5, 1.0, 7.0, 999.0, 12345.678, 399_999.0, 1e6, 1e7, 1.0001e7, 1e8,
    1e9, 1e300, float("nan"), float("inf"),
)  # fmt: skip
"""Sampling rates [Hz]."""

UNITS = ("Pa", "", "N m", "rad", "V", "\x00", "m/s^2", "x" * 300, "%", "é", "Pa\n", "\x1b[2J")

NAMES = ("torque", "pressure", "angle", "x" * 300, "", "a\nb", "\x07", "time", "../up", "é")

SEVERAL = (1e300, -1e300, float("nan"), float("inf"), 5e-324, 1e30, 0.0)

INFLATED = 150 << 20
"""What an archive inflates to beyond what is right for its size [byte]."""


def _samples(rng: Rng, kinds: bool = True) -> np.ndarray:
    """Return samples of any length, kind and size."""
    n = pick(rng, (0, 1, 15, 16, 17, 300, 3000))
    values = rng.normal(size=n) * pick(rng, (1.0, 1e-30, 1e30, 0.0))
    if n and rng.random() < 0.3:
        values[int(rng.integers(n))] = pick(rng, SEVERAL)
    types = ("f8", "f4", "f2", "i1", "i2", "u4", "i8", "?", "c16") if kinds else ("f8", "f4", "i2")
    with np.errstate(all="ignore"):
        return values.astype(pick(rng, types))


def wav(content: bytes, rng: Rng) -> bytes:
    """Return a WAV of another rate, number of tracks, coding or announced length."""
    head = bytearray(content)
    at, form, n = pick(
        rng,
        ((24, "<I", RATE_CLAIMS), (22, "<H", (0, 2, 64, 65535)), (34, "<H", (0, 1, 8, 64, 65535)),
         (20, "<H", (0, 1, 2, 6, 17, 65534)), (4, "<I", CLAIMS), (40, "<I", CLAIMS),
         (32, "<H", (0, 1, 65535))),
    )  # fmt: skip
    struct.pack_into(form, head, at, pick(rng, n))
    return bytes(head)


RATE_CLAIMS = (0, 1, 7, 999, 400_001, 10**7, 10**7 + 1, 10**8, 10**9, 2**31 - 1, 2**32 - 1)
CLAIMS = (0, 1, 7, 2**31 - 1, 2**31, 2**32 - 1)


def hdf5(content: bytes, rng: Rng) -> bytes:
    """Return an HDF5 file with odd attributes, shapes, types, links or empty storage."""
    import h5py

    made = io.BytesIO()
    with h5py.File(made, "w", track_order=True) as file:
        for k in range(pick(rng, (0, 1, 1, 2, 40))):
            name = f"mic{k}" if rng.random() < 0.7 else f"{pick(rng, NAMES[:4])}{k}"
            kind = int(rng.integers(8))
            if kind == 0:  # lengths that nothing is stored of
                shape = pick(rng, ((10**10,), (2, 10**9), (10**15,), (3, 4, 5), (), (0,)))
                chunks = (1000,) if len(shape) == 1 and shape[0] else None
                if chunks is None and np.prod(shape) > 10**6:
                    chunks = (1, 1000)
                data = file.create_dataset(name, shape=shape, dtype="f8", chunks=chunks)
            elif kind == 1:
                data = file.create_dataset(name, data=[b"a", b"bc"])
            elif kind == 2:
                zeros = np.zeros(pick(rng, (1000, 2_000_000)), "i1")
                data = file.create_dataset(name, data=zeros, compression="gzip")
            elif kind == 3:
                file[name] = pick(
                    rng, (h5py.SoftLink("/nowhere"), h5py.ExternalLink("/etc/passwd", "x"),
                          h5py.SoftLink(f"/{name}")),
                )  # fmt: skip
                continue
            else:
                samples = _samples(rng)
                data = file.create_dataset(name, data=samples)
            _describe(data.attrs, rng)
        for key in ("speed_rad_s", "material", "rate_Hz"):
            if rng.random() < 0.3:
                file.attrs[key] = pick(rng, (5.0, "x", np.nan, [1.0, 2.0], b"\xff", -1, 1e308))
    return made.getvalue()


def _describe(attrs: Any, rng: Rng) -> None:
    if rng.random() < 0.9:
        attrs["rate_Hz"] = pick(rng, (51200.0, *RATES, "48000", [48000.0], np.int8(-1), "x"))
    if rng.random() < 0.9:
        unit = pick(rng, ("Pa", *UNITS, 7, [b"Pa"]))
        attrs["unit"] = unit.replace("\x00", "0") if isinstance(unit, str) else unit


def tdms(content: bytes, rng: Rng) -> bytes:
    """Return a TDMS file with odd increments, units, types and lengths."""
    from nptdms import ChannelObject, RootObject, TdmsWriter

    made = io.BytesIO()
    with TdmsWriter(made) as file:
        channels = [RootObject({"speed_rad_s": pick(rng, (5.0, "x", float("nan"), -1))})]
        for k in range(pick(rng, (0, 1, 2, 40))):
            samples = _samples(rng)
            samples = samples.astype("f8") if samples.dtype.kind in "c" else samples
            rate = pick(rng, (51200.0, *RATES))
            step = 1.0 / rate if rate else 0.0
            said = {
                "wf_increment": pick(rng, (step, step, "x", 0)),
                "unit_string": pick(rng, UNITS),
            }
            channels.append(ChannelObject("run", f"{pick(rng, NAMES)}{k}", samples, said))
        file.write_segment(channels)
    return made.getvalue()


def mdf(content: bytes, rng: Rng) -> bytes:
    """Return an MDF file with odd times, units, types and lengths."""
    import tempfile
    from pathlib import Path

    from asammdf import MDF, Signal

    with tempfile.TemporaryDirectory() as folder, MDF(version="4.10") as file:
        for k in range(pick(rng, (1, 1, 2, 5))):
            samples = _samples(rng, kinds=False)
            with np.errstate(all="ignore"):
                time = np.arange(samples.size) / np.float64(pick(rng, (51200.0, *RATES)))
            if rng.random() < 0.2:
                time = time[::-1].copy()
            unit = pick(rng, UNITS)
            file.append([Signal(samples, time, unit=unit, name=f"{pick(rng, NAMES)}{k}")])
        path = Path(folder) / "made.mf4"
        file.save(path, overwrite=True, compression=pick(rng, (0, 2)))
        return path.read_bytes()


def uff(content: bytes, rng: Rng) -> bytes:
    """Return a universal file with other numbers in its header."""
    lines = content.split(b"\n")
    at = int(rng.integers(min(len(lines), 14)))
    numbers = lines[at].split()
    if numbers:
        other = pick(rng, (b"0", b"-1", b"1e300", b"nan", b"999999999", b"58", b"151", b"", b"x"))
        lines[at] = lines[at].replace(pick(rng, numbers), other, 1)
    return b"\n".join(lines)


def npy(content: bytes, rng: Rng) -> bytes:
    """Return an NPY file with another header, or an array of another kind."""
    if rng.random() < 0.5:
        return _npy(_array(rng))
    _, _, rest = content.partition(b"\n")
    return _header(_announced(rng)) + rest[: pick(rng, (0, 100, len(rest)))]


def _npy(array: np.ndarray) -> bytes:
    made = io.BytesIO()
    np.save(made, array)
    return made.getvalue()


def _header(text: str) -> bytes:
    head = text.encode("latin1", "replace") + b"\n"
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(head) & 0xFFFF) + head


def _announced(rng: Rng) -> str:
    kind = pick(
        rng, ("<f8", "<f8", "|O", ">f4", "<U9999999", "V99999999", "<M8[s]", "x", "", "<c16", "|b1")
    )
    shape = pick(
        rng,
        ("(1000, 3)", "(10**9, 3)", "(10000000000, 3)", "(-1, 3)", "(3,)", "()", "(0, 3)", "3",
         "(1.5, 3)", "('a',)", "(9999999999999999999999, 3)", "(True, 3)", "(" * 60 + ")" * 60),
    )  # fmt: skip
    return pick(
        rng,
        (f"{{'descr': '{kind}', 'fortran_order': {pick(rng, ('False', 'True', '7'))}, "
         f"'shape': {shape}, }}",
         f"{{'descr': [('a', '{kind}')], 'fortran_order': False, 'shape': {shape}}}",
         "{" * 500, "'''", "{'descr'", "__import__('os')", f"[{shape}]"),
    )  # fmt: skip


def _array(rng: Rng) -> np.ndarray:
    made = (
        np.zeros(0), np.zeros((3, 0)), np.float64(5.0), np.full((1000, 3), np.nan), np.ones((3, 2)),
        np.array(["a", "b"]), np.array([b"x" * 900]), np.array([None, 1], dtype=object),
        np.array(["2020-01-01"], "M8[D]"), np.full((100, 3), 1e300), np.ones((40,), complex),
        np.arange(3000, dtype="u1").reshape(3, 1000), np.full(40, -1, "i8"), np.full(40, 2**40),
        np.array([(1, 2.0)], [("a", "i4"), ("b", "f8")]), rng.normal(size=(20, 20, 20)),
        np.full((1000, 3), np.inf), np.array("{}"), np.array("[" * 900), np.array(1e308),
    )  # fmt: skip
    return np.asarray(pick(rng, made))


def npz(content: bytes, rng: Rng) -> bytes:
    """Return an archive in which one member is lost, damaged, of another kind or inflates."""
    held = dict(_members(content))
    name = pick(rng, list(held))
    doing = int(rng.integers(8))
    if doing == 0:
        del held[name]
    elif doing == 1:
        held[pick(rng, ("x", "header", "../up.npy", "header.npy", "\x1b.npy"))] = held[name]
    elif doing == 2:
        return _zipped(held, {name: pick(rng, (zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA))})
    elif doing == 3 and rng.random() < 0.3:
        return _zipped({**held, name: b"\x93NUMPY\x01\x00" + b"\0" * 9_999_999}, {})
    elif doing == 3 and rng.random() < 0.1:
        return _inflating()
    elif doing == 4:
        held[name] = pick(rng, BYTES)(held[name], rng)
    elif doing == 5:
        held[name] = npy(held[name], rng)
    elif doing == 6:
        held[name] = _other_values(held[name], rng)
    else:
        held[name] = _npy(_array(rng))
    whole = _zipped(held, {})
    return pick(rng, BYTES)(whole, rng) if rng.random() < 0.1 else whole


def _other_values(member: bytes, rng: Rng) -> bytes:
    """Return an array of the same shape and kind with a few values far out."""
    try:
        array = np.load(io.BytesIO(member), allow_pickle=False).copy()
    except Exception:
        return member
    if array.dtype.kind not in "iuf" or not array.size:
        text = str(array)
        return _npy(np.array(pick(rng, TEXT)(text.encode(), rng).decode("utf-8", "replace")))
    flat = array.reshape(-1)
    for _ in range(3):
        with np.errstate(all="ignore"):
            value = pick(rng, (-1, 0, 2**31 - 1, 10**6, float("nan"), float("inf"), 1e300))
            flat[int(rng.integers(flat.size))] = np.asarray(value).astype(array.dtype)
    return _npy(array)


@cache
def _members(content: bytes) -> tuple[tuple[str, bytes], ...]:
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        return tuple((one.filename, archive.read(one)) for one in archive.infolist())


def _zipped(held: dict[str, bytes], kinds: dict[str, int]) -> bytes:
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w") as archive:
        for name, member in held.items():
            archive.writestr(name, member, kinds.get(name, zipfile.ZIP_STORED))
    return made.getvalue()


@cache
def _inflating() -> bytes:
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
        archive.writestr("header.npy", _header(
            f"{{'descr': '|u1', 'fortran_order': False, 'shape': ({INFLATED},), }}"
        ) + bytes(INFLATED))  # fmt: skip
    return made.getvalue()


def workbook(content: bytes, rng: Rng) -> bytes:
    """Return a workbook in which a part of XML is damaged, lost or blown up."""
    held = dict(_members(content))
    name = pick(rng, list(held))
    doing = int(rng.integers(12))
    if doing == 0:
        del held[name]
    elif doing == 1:
        entities = b"".join(
            b'<!ENTITY e%d "%s">' % (k, b"&e%d;" % (k - 1) * 10) for k in range(1, 9)
        )
        held[name] = b'<!DOCTYPE x [<!ENTITY e0 "ha">' + entities + b"]><x>&e8;</x>"
    elif doing == 2:
        sheet = next(one for one in held if "sheet1" in one)
        text = held[sheet].replace(b'r="2"', b'r="%d"' % pick(rng, (1048576, 10**9, 0)))
        held[sheet] = text.replace(b'"A2"', pick(rng, (b'"XFD1048576"', b'"ZZZZ2"', b'"A-1"')))
    elif doing == 3:
        held[name] = held[name] + b" " * 20_000_000
        return _deflated(held)
    else:
        held[name] = pick(rng, TEXT)(held[name], rng)
    return _zipped(held, {})


def _deflated(held: dict[str, bytes]) -> bytes:
    return _zipped(held, dict.fromkeys(held, zipfile.ZIP_DEFLATED))


def parquet(content: bytes, rng: Rng) -> bytes:
    """Return a table with columns of other kinds, or of very many rows."""
    import pyarrow as pa
    from pyarrow import parquet as format_

    table = format_.read_table(io.BytesIO(content))
    names = list(table.column_names)
    n = table.num_rows
    for _ in range(int(rng.integers(1, 4))):
        at = int(rng.integers(len(names)))
        values = pick(
            rng,
            ([None] * n, [[1, 2]] * n, [{"a": 1}] * n, [b"\xff\xfe"] * n, [float("nan")] * n,
             [10**18] * n, [True] * n, ["\x1b[2J"] * n, [-1.0] * n, ["a\nb"] * n, ["=1+1"] * n),
        )  # fmt: skip
        table = table.set_column(at, names[at], pa.array(values))
    if rng.random() < 0.1:
        table = pa.concat_tables([table] * 5000)
    if rng.random() < 0.2:
        table = table.rename_columns(
            [pick(rng, ("file", "label", "", "x", name)) for name in names]
        )
    made = io.BytesIO()
    format_.write_table(table, made)
    whole = made.getvalue()
    return pick(rng, BYTES)(whole, rng) if rng.random() < 0.3 else whole

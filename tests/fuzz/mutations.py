"""Damage of any file: bytes, text, JSON and names. What knows a format lies in `hostile_files`."""

from __future__ import annotations

import copy
import json
import re
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable

    import numpy as np

    Rng = np.random.Generator
    Mutation = Callable[[bytes, Rng], bytes]

__all__ = ["BYTES", "JSON", "NAMES", "TEXT", "damage_json", "pick"]

WHOLE = (0, 1, 2, 3, 24, 255, 4096, 65535, 10**8, 2**31 - 1, 2**31, 2**32 - 1, 2**62, 2**64 - 1)
"""Counts, lengths, offsets and rates that a header may claim."""

WORDS = (
    "nan", "inf", "-inf", "-1", "0", "1e308", "1e-308", "1e999", "9" * 400, "-0.0", "1_000",
    "0x7f", "", '"', "true", "[]", "{}", "null", "'x'", '""', "\\", ",", "\t", "\x00", "\x1b[31m",
    "\x07", "\ufeff", "\u202e", "é" * 3, "=1+1", "../../etc/passwd", "/dev/zero", "1979-05-27",
    "[[[[[[]]]]]]", "x" * 20_000, "fixed", "1..2..3", "0..1e9", "1e-9",
)  # fmt: skip

VALUES: tuple[Any, ...] = (
    None, True, -1, 0, 10**400, 1e308, -1e-308, float("nan"), float("inf"), "", "nan", "5",
    "x" * 5000, "\x1b]0;x\x07", "=cmd|' /C calc'!A0", "a\nb", "\ud800", [], {}, [[]], [None] * 9,
    [1, "a", None], {"": {}}, {"unit": "Pa"}, list(range(300)),
)  # fmt: skip

NAMES = (
    "=cmd", "+1", "-out", "@sum", "\x1b]0;x\x07", "a\nb", "a\rb", "\udcff\udcfe", "a,b", "a;b",
    'q"', "'", " ", "é\u0301", "\u202egpj", "x" * 200, "%s%n{0}", "$(id)", "~", "#", "tab\there",
    "\U0001f50a", "--help", "nul\u2028line", "a\x85b",
)  # fmt: skip
"""Stems of files; a name that cannot be UTF-8 has surrogates, as `os.fsdecode` gives them."""


def pick(rng: Rng, items: Any) -> Any:
    """Return one of them."""
    return items[int(rng.integers(len(items)))]


def _place(content: bytes, rng: Rng) -> int:
    """Choose where to damage: half the time in the header."""
    n = max(1, len(content))
    return int(rng.integers(min(n, 400) if rng.random() < 0.5 else n))


def flip(content: bytes, rng: Rng) -> bytes:
    """Change a few bytes to any."""
    changed = bytearray(content)
    for _ in range(int(rng.integers(1, 9)) if content else 0):
        changed[_place(content, rng)] = int(rng.integers(256))
    return bytes(changed)


def claim(content: bytes, rng: Rng) -> bytes:
    """Overwrite what may be a count, a length, a rate or an offset."""
    changed = bytearray(content)
    for _ in range(int(rng.integers(1, 4))):
        width = pick(rng, (1, 2, 4, 8))
        order = pick(rng, ("little", "big"))
        at = _place(content, rng) // width * width
        changed[at : at + width] = (pick(rng, WHOLE) % 256**width).to_bytes(width, order)
    return bytes(changed)


def cut(content: bytes, rng: Rng) -> bytes:
    """Keep the beginning."""
    return content[: _place(content, rng)]


def lose(content: bytes, rng: Rng) -> bytes:
    """Leave a piece out."""
    at = _place(content, rng)
    return content[:at] + content[at + int(rng.integers(1, 1 + max(1, len(content) // 4))) :]


def insert(content: bytes, rng: Rng) -> bytes:
    """Put random bytes in."""
    at = _place(content, rng)
    return content[:at] + rng.bytes(int(rng.integers(1, 300))) + content[at:]


def repeat(content: bytes, rng: Rng) -> bytes:
    """Put a piece in again, once or many times."""
    at = _place(content, rng)
    piece = content[at : at + int(rng.integers(1, 400))]
    return content[:at] + piece * pick(rng, (2, 3, 50)) + content[at:]


def blank(content: bytes, rng: Rng) -> bytes:
    """Overwrite a stretch with one byte, as a bad sector does."""
    at, n = _place(content, rng), int(rng.integers(1, 600))
    return content[:at] + bytes([pick(rng, (0, 255))]) * n + content[at + n :]


def splice(content: bytes, rng: Rng) -> bytes:
    """Join its beginning to a later piece of itself."""
    return content[: _place(content, rng)] + content[_place(content, rng) :]


def garbage(content: bytes, rng: Rng) -> bytes:
    """Leave the first bytes at most."""
    return content[: pick(rng, (0, 0, 4, 8, 16, 64))] + rng.bytes(int(rng.integers(0, 2000)))


def empty(content: bytes, rng: Rng) -> bytes:
    """Leave nothing, or next to it."""
    return pick(rng, (b"", b"", b"\0", b"\n", b"\xef\xbb\xbf", b"\xff\xfe"))


BYTES: tuple[Mutation, ...] = (
    flip, flip, claim, claim, claim, cut, lose, insert, repeat, blank, splice, garbage, empty,
)  # fmt: skip


def word(content: bytes, rng: Rng) -> bytes:
    """Put a hostile word in the place of one."""
    text = content.decode("utf-8", "replace")
    words = list(re.finditer(r"[\w.+-]+", text))
    for _ in range(int(rng.integers(1, 3)) if words else 0):
        found = pick(rng, words)
        text = text[: found.start()] + pick(rng, WORDS) + text[found.end() :]
    return text.encode("utf-8", "replace")


def line(content: bytes, rng: Rng) -> bytes:
    """Lose, repeat or move a line."""
    lines = content.splitlines(keepends=True) or [b""]
    at = int(rng.integers(len(lines)))
    one = lines.pop(at)
    again = pick(rng, (0, 0, 2, 2000))
    to = at if again else int(rng.integers(len(lines) + 1))
    kept = [one] * again if again else [one] * int(rng.integers(2))
    return b"".join([*lines[:to], *kept, *lines[to:]])


def sign(content: bytes, rng: Rng) -> bytes:
    """Change a sign of the syntax for another, here or everywhere."""
    signs = b",;:=\"'[]{}\n\t#.-"
    one, other = pick(rng, signs), pick(rng, signs)
    times = pick(rng, (1, 1, -1))
    return content.replace(bytes([one]), bytes([other]), times)


def encoding(content: bytes, rng: Rng) -> bytes:
    """Write it in another encoding, or break one letter of it."""
    text = content.decode("utf-8", "replace")
    at = _place(content, rng)
    return pick(
        rng,
        (
            text.encode("utf-16"), text.encode("utf-32"), b"\xef\xbb\xbf" + content,
            content[:at] + b"\xff\xfe\xe9" + content[at:], content[:at] + b"\0" + content[at:],
            content.replace(b"\n", b"\r"), content.replace(b"\n", b"\r\n"),
        ),
    )  # fmt: skip


def deep(content: bytes, rng: Rng) -> bytes:
    """Put what is deep in the place of a word, or of the whole."""
    n = pick(rng, (50, 101, 1000, 20_000, 100_000))
    kind = pick(rng, (b"[", b'{"a":', b"{a=", b"a.", b"(", b"-", b"<a>"))
    close = {b"[": b"]", b'{"a":': b"}", b"{a=": b"}", b"(": b")"}.get(kind, b"")
    nest = kind * n + b"1" + close * n
    words = list(re.finditer(rb"[\w.+-]+", content))
    if not words or rng.random() < 0.3:
        return nest
    found = pick(rng, words)
    return content[: found.start()] + nest + content[found.end() :]


TEXT: tuple[Mutation, ...] = (
    word, word, word, word, line, line, sign, encoding, deep, flip, cut, insert, repeat, empty,
)  # fmt: skip


def damage_json(content: bytes, rng: Rng) -> bytes:
    """Put a value of the wrong kind somewhere, lose a key, or say another."""
    data = json.loads(content.splitlines()[0] if content.count(b"\n") < 4 else content)
    for _ in range(int(rng.integers(1, 3))):
        data = _changed(data, rng)
    return json.dumps(data).encode("ascii")


JSON: tuple[Mutation, ...] = (damage_json,) * 10 + TEXT


def _changed(data: Any, rng: Rng) -> Any:
    within = [data]
    for held in within:  # the list grows while it is gone through
        inside = held.values() if isinstance(held, dict) else held
        within += [one for one in inside if isinstance(one, dict | list)]
    held = pick(rng, [one for one in within if one] or [[0]])
    if rng.random() < 0.02:
        return _value(rng)
    keys = list(held) if isinstance(held, dict) else range(len(held))
    key = pick(rng, list(keys))
    doing = int(rng.integers(10))
    if doing == 0:
        del held[key]
    elif doing == 1 and isinstance(held, dict):
        held[pick(rng, ("", "x" * 500, str(key).upper(), f"{key} ", "\x1b"))] = held[key]
    elif doing == 2 and isinstance(held, list):
        held.extend(held * pick(rng, (1, 50)))
    else:
        held[key] = _value(rng)
    return data


def _value(rng: Rng) -> Any:
    return copy.deepcopy(pick(rng, VALUES))

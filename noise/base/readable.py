r"""Names and messages as they may be shown: on a terminal, in a table, on a page.

Names of files may hold anything. Bytes that are no UTF-8 cannot be written as text, characters that
control a terminal can clear it, or write into its title, and those that turn the direction of
writing make a name look like another; all are shown as a backslash and their code, such as ``\xe9``
or ``\x1b``.
"""

from __future__ import annotations

import os
import re

__all__ = ["readable"]

_CONTROL = re.compile(r"[\x00-\x1f\x7f-\x9f\u200e\u200f\u2028-\u202e\u2066-\u2069]")


def readable(text: str) -> str:
    r"""Return a text without what cannot be shown.

    Examples
    --------
    >>> print(readable("run07.wav"), readable("\x1b[2J\a.wav"), readable("caf\udce9.wav"))
    run07.wav \x1b[2J\x07.wav caf\xe9.wav
    """
    if not text.isascii():
        text = _bytes(text).decode("utf-8", "backslashreplace")
    return _CONTROL.sub(_code, text)


def _bytes(text: str) -> bytes:
    try:
        return os.fsencode(text)
    except UnicodeEncodeError:  # of a system whose names are in another code
        return text.encode("utf-8", "surrogatepass")


def _code(found: re.Match[str]) -> str:
    number = ord(found[0])
    return f"\\x{number:02x}" if number < 0x100 else f"\\u{number:04x}"

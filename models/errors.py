"""The exceptions of bushing-noise, as few as callers need to tell apart.

Every message names the place (file, channel, field), the value found and what would be right,
in one line: the command line shows it as it is.
"""

from __future__ import annotations

__all__ = ["BushingNoiseError", "ParameterError", "RecordingError", "not_installed"]


class BushingNoiseError(Exception):
    """Root of all errors that bushing-noise raises on purpose."""


class ParameterError(BushingNoiseError, ValueError):
    """A value, name or option that cannot be used; the call as a whole is refused."""


class RecordingError(BushingNoiseError):
    """A recording that cannot be read; a batch goes on with the next file."""


def not_installed(what: str, package: str, extra: str) -> str:
    """Message of an error for a missing extra: `what` is a subject with its verb.

    Examples
    --------
    >>> not_installed("Parquet needs", "pyarrow", "parquet")
    'Parquet needs pyarrow, which is not installed; run: pip install "bushing-noise[parquet]"'
    """
    command = f'pip install "bushing-noise[{extra}]"'
    return f"{what} {package}, which is not installed; run: {command}"

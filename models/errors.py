"""The exceptions of bushing-noise, as few as callers need to tell apart.

Every message names the place (file, channel, field), the value found and what would be right,
in one line: the command line shows it as it is. Values come from files, and may be of any length
and hold line breaks; so the root makes of each message one line that can be read.
"""

from collections.abc import Iterator
from contextlib import contextmanager

_LONGEST = 2000
"""Letters of a message, of which the end is left out."""


class BushingNoiseError(Exception):
    r"""Root of all errors that bushing-noise raises on purpose.

    Parameters
    ----------
    message : str
        Becomes one line of bounded length.

    Examples
    --------
    >>> print(BushingNoiseError("run07.json: unit is 'N\nm'; it must be one of a channel's"))
    run07.json: unit is 'N m'; it must be one of a channel's
    """

    def __init__(self, message: str = "") -> None:
        line = " ".join(str(message).splitlines())
        super().__init__(line if len(line) <= _LONGEST else f"{line[:_LONGEST]} ...")


class ParameterError(BushingNoiseError, ValueError):
    """A value, name or option that cannot be used; the call as a whole is refused."""


class RecordingError(BushingNoiseError):
    """A recording that cannot be read; a batch goes on with the next file."""


@contextmanager
def naming(place: str, error: type[BushingNoiseError] | None = None) -> Iterator[None]:
    """Let errors of the block name a place before what they say, such as an option.

    Parameters
    ----------
    place : str
        With what stands between it and the message.
    error : type, optional
        Of the error; by default it stays what it is.

    Raises
    ------
    BushingNoiseError
        Whatever the block raises of these, with the place.

    Examples
    --------
    >>> with naming("--rig: "):
    ...     raise ParameterError("rig.toml: there is no such file")
    Traceback (most recent call last):
    models.errors.ParameterError: --rig: rig.toml: there is no such file
    """
    try:
        yield
    except BushingNoiseError as wrong:
        raise (error or type(wrong))(f"{place}{wrong}") from None


def not_installed(what: str, package: str, extra: str) -> str:
    """Message of an error for a missing extra: `what` is a subject with its verb.

    Examples
    --------
    >>> not_installed("Parquet needs", "pyarrow", "parquet")
    'Parquet needs pyarrow, which is not installed; run: pip install "bushing-noise[parquet]"'
    """
    command = f'pip install "bushing-noise[{extra}]"'
    return f"{what} {package}, which is not installed; run: {command}"

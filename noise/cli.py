"""The command line of ``bushing-noise``: it finds the command, runs it, and reports errors.

What a user can cause ends in one line on standard error and an exit code, never in a traceback:
0 all done, 1 done but inputs were refused, 2 the call cannot be used. Beyond these a program that
is interrupted (130) or whose reader goes away (141) ends as the shell has it. An error that nobody
foresaw is told in one line as well, with the place in the code; ``python -X dev -m noise`` shows
the whole traceback.

Only the command that is called is imported, so that help is there at once.
"""

from __future__ import annotations

import argparse
import gc
import re
import sys
import traceback
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

from models.errors import BushingNoiseError, RecordingError
from noise.base.progress import discard, note, say
from noise.commands import COMMANDS, load_command

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = ["main"]

_NAME = "bushing-noise"
_REFUSED = 1
_USAGE_ERROR = 2
_INTERRUPTED = 130  # 128 + SIGINT
_CLOSED_PIPE = 141  # 128 + SIGPIPE

_NEW_OBJECTS = 100_000
"""After which garbage is looked for: libraries and compiled functions, which stay, are most of what
there is, and looking through them as often as by default takes a tenth of a command's time."""

_NEGATIVE = re.compile(r"-(\.?\d|inf|nan)", re.IGNORECASE)


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line.

    Parameters
    ----------
    argv : sequence of str, optional
        Arguments without the name of the program; by default those of the process.

    Returns
    -------
    int
        Exit code.

    Examples
    --------
    >>> main(["--help"])
    usage: bushing-noise ...
    0
    """
    arguments = list(sys.argv[1:] if argv is None else argv)
    if argv is None:  # who calls from a program of their own keeps their settings
        gc.set_threshold(_NEW_OBJECTS, 20, 50)
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):  # names of files that the terminal cannot show
            stream.reconfigure(errors="backslashreplace")
    with warnings.catch_warnings():
        warnings.showwarning = _show_warning
        try:
            return _report_errors(arguments)
        except BrokenPipeError:
            discard(sys.stdout)
            return _CLOSED_PIPE
        finally:
            if argv is None:  # the process ends: to look through what it leaves takes 0.3 s
                gc.freeze()


def _report_errors(arguments: list[str]) -> int:
    """Run the command; say in one line what goes wrong."""
    try:
        code = _run(arguments)
        if sys.stdout is not None:
            sys.stdout.flush()
        return code
    except RecordingError as error:  # the only input that there was
        say(f"{_NAME}: refused: {error}")
        return _REFUSED
    except BushingNoiseError as error:
        return _failed(str(error))
    except MemoryError:
        return _failed("this needs more memory than there is; try a shorter recording")
    except KeyboardInterrupt:
        say(f"{_NAME}: interrupted")
        return _INTERRUPTED
    except BrokenPipeError:
        raise
    except OSError as error:
        discard(sys.stdout)
        return _failed(f"{error.filename or 'output'}: {error.strerror or error}")
    except Exception as error:
        if sys.flags.dev_mode:
            raise
        place = traceback.extract_tb(error.__traceback__)[-1]
        where = f"{Path(place.filename).name}, line {place.lineno}"
        return _failed(f"unexpected, please report: {type(error).__name__}: {error} ({where})")


def _run(arguments: list[str]) -> int:
    parser = _parser(arguments)
    if not arguments:
        parser.print_help(sys.stderr)
        return _USAGE_ERROR
    try:
        options, unknown = parser.parse_known_args(_with_negative_values(arguments))
    except SystemExit as stop:  # 0 after help, 2 after an error
        return stop.code if isinstance(stop.code, int) else 0
    if unknown:
        options_there = f"see {_NAME} {options.command} --help"
        return _failed(f"unrecognized: {' '.join(unknown)} ({options_there})")
    return load_command(options.command).run(options)


def _failed(message: str) -> int:
    say(f"{_NAME}: error: {message}")
    return _USAGE_ERROR


def _path(text: str) -> Path:
    if not text:
        raise argparse.ArgumentTypeError("is '', expected a path ('.' is the current folder)")
    return Path(text)


class _Parser(argparse.ArgumentParser):
    def __init__(self, *arguments: Any, **options: Any) -> None:
        super().__init__(*arguments, **options)
        self.register("type", Path, _path)

    def error(self, message: str) -> NoReturn:
        """Tell an error of the call in one line."""
        _failed(f"{_plain(message)} (see {self.prog} --help)")
        raise SystemExit(_USAGE_ERROR)


def _plain(message: str) -> str:
    """Let a value's message follow its option: ``--speed is 'x', expected ...``."""
    return re.sub(r"^argument ([^:]+): is ", r"\1 is ", message)


class _Version(argparse.Action):
    def __call__(self, *_: object) -> None:
        """Print the installed version."""
        from importlib.metadata import PackageNotFoundError, version

        try:
            installed = version(_NAME)
        except PackageNotFoundError:
            installed = "(run from its source, not installed)"
        sys.stdout.write(f"{_NAME} {installed}\n")
        raise SystemExit(0)


def _parser(arguments: Sequence[str]) -> argparse.ArgumentParser:
    """All commands by name and line; options only of those that the arguments mention."""
    parser = _Parser(
        prog=_NAME,
        description="Simulate, hear, label and explain the creak, squawk and squeal of a rubber "
        "bushing.",
        epilog=f"{_NAME} COMMAND --help explains each command. Exit code 0: all done; 1: done, "
        "but some inputs were refused; 2: the call cannot be used.",
        allow_abbrev=False,
    )
    parser.add_argument("--version", action=_Version, nargs=0, help="print the version and stop")
    commands = parser.add_subparsers(
        dest="command", metavar="COMMAND", required=True, title="commands"
    )
    for name, entry in COMMANDS.items():
        command = commands.add_parser(name, help=entry.line, allow_abbrev=False)
        if name in arguments:
            load_command(name).configure(command)
    return parser


def _with_negative_values(arguments: Sequence[str]) -> list[str]:
    """Tie negative values to their options: ``--speed -5..5`` becomes ``--speed=-5..5``.

    Left alone, the parser takes all but plain negative numbers for options.
    """
    tied: list[str] = []
    for argument in arguments:
        option = tied[-1] if tied else ""
        if option.startswith("--") and "=" not in option and _NEGATIVE.match(argument):
            tied[-1] = f"{option}={argument}"
        else:
            tied.append(argument)
    return tied


def _show_warning(message: Warning | str, *_: object, **__: object) -> None:
    note(str(message))

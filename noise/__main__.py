"""``python -m noise`` is the command ``bushing-noise``."""

from __future__ import annotations

import os
import signal
import sys

__all__ = ["run"]


def run() -> None:
    """Run the command line, and end the process with its exit code.

    An interrupt ends the process at once while the program is loaded and after it has run; in
    between the command keeps what is done.
    """
    signal.signal(signal.SIGINT, _end)
    from noise.cli import main

    try:
        signal.signal(signal.SIGINT, signal.default_int_handler)
        code = main()
    except KeyboardInterrupt:  # a second one, while the first was dealt with
        code = 130  # 128 + SIGINT
    finally:
        signal.signal(signal.SIGINT, _end)
    sys.exit(code)


def _end(*_: object) -> None:
    """End a command that has nothing to lose."""
    os.write(2, b"bushing-noise: interrupted\n")
    os._exit(130)  # 128 + SIGINT


if __name__ == "__main__":
    run()

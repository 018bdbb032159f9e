"""Entry point of ``bushing-noise`` and ``python -m noise``."""

from __future__ import annotations

import os
import signal
import sys


def run() -> None:
    """Run the command line and exit with its code.

    During import and after the run an interrupt ends the process at once; during the run the
    command handles it.
    """
    signal.signal(signal.SIGINT, _end)
    from noise.cli import main

    try:
        signal.signal(signal.SIGINT, signal.default_int_handler)
        code = main()
    except KeyboardInterrupt:  # a second one, while the first is handled
        code = 130  # 128 + SIGINT
    finally:
        signal.signal(signal.SIGINT, _end)
    sys.exit(code)


def _end(*_: object) -> None:
    """Exit at once after an interrupt."""
    os.write(2, b"bushing-noise: interrupted\n")
    os._exit(130)  # 128 + SIGINT


if __name__ == "__main__":
    run()

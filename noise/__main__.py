"""``python -m noise`` is the command ``bushing-noise``."""

from __future__ import annotations

import signal
import sys

__all__ = ["run"]


def run() -> None:
    """Run the command line, and end the process with its exit code.

    Until then an interrupt ends the process at once, as `noise` has it; from then on what was done
    is kept.
    """
    from noise.cli import main

    signal.signal(signal.SIGINT, signal.default_int_handler)
    sys.exit(main())


if __name__ == "__main__":
    run()

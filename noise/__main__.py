"""``python -m noise`` is the command ``bushing-noise``."""

from __future__ import annotations

import signal
import sys

__all__ = ["run"]


def run() -> None:
    """Run the command line, and end the process with its exit code.

    Before and after an interrupt ends the process at once, as `noise` has it; in between what was
    done is kept.
    """
    from noise.cli import main

    at_once = signal.getsignal(signal.SIGINT)
    try:
        signal.signal(signal.SIGINT, signal.default_int_handler)
        code = main()
    except KeyboardInterrupt:  # a second one, while the first was dealt with
        code = 130  # 128 + SIGINT
    finally:
        signal.signal(signal.SIGINT, at_once)
    sys.exit(code)


if __name__ == "__main__":
    run()

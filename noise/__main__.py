"""``python -m noise`` is the command ``bushing-noise``."""

from __future__ import annotations

import sys

from noise.cli import main

if __name__ == "__main__":
    sys.exit(main())

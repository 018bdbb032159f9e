"""Entry point of ``bushing-noise`` and ``python -m noise``."""

import sys


def run() -> None:
    """Run the command line and exit with its code."""
    try:
        from noise.cli import main

        code = main()
    except KeyboardInterrupt:  # during an import, or while another one is handled
        sys.stderr.write("bushing-noise: interrupted\n")
        code = 130  # 128 + SIGINT
    sys.exit(code)


if __name__ == "__main__":
    run()

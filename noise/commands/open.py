"""``bushing-noise open``: a local app in the browser to listen, correct, design and compare."""

from __future__ import annotations

from argparse import Namespace
from pathlib import Path

from models.errors import ParameterError
from noise.base.progress import say
from noise.commands.options import Option, check_folder, whole_number

OPTIONS = (
    Option("paths PATH", Path, count="*"),
    Option("--out TABLE", Path),
    Option("--save-to FOLDER", Path),
    Option("--port PORT", whole_number(0, most=65535), 0),
    Option("--no-browser"),
)


def run(options: Namespace) -> int:
    """Serve the app until the user stops it."""
    from noise.app.opened import open_paths
    from noise.app.server import serve

    check_folder(options.save_to, "--save-to")
    opened = open_paths(options.paths, options.out, options.seed, options.save_to)

    def ready(address: str) -> None:
        print(address, flush=True)
        if opened.table is not None:
            say(f"corrections are written to {opened.table}")
        if not options.no_browser:
            import webbrowser

            webbrowser.open(address)

    try:
        serve(opened, options.port, ready)
    except OSError as error:
        raise ParameterError(f"--port {options.port}: {error.strerror or error}") from None
    return 0

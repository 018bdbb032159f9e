"""``bushing-noise open``: a local app in the browser to listen, correct, design and compare."""

from __future__ import annotations

from argparse import Namespace
from pathlib import Path

from models.errors import ParameterError
from noise.commands.options import Option, check_folder, seed, whole_number

DESCRIPTION = (
    "Open recordings, a label table or a rig in a local app: listen, see, correct labels, hear "
    "a design while it is changed, compare sounds blind. Its address is the first line on "
    "standard output; only this machine reaches it, and only by that address. It stops by the "
    "button Quit, or by Ctrl-C here. Corrections and votes are written at once."
)

EPILOG = (
    "examples: bushing-noise open recordings; bushing-noise open labels.csv; "
    "bushing-noise open RIG.toml"
)

OPTIONS = (
    Option("paths PATH", Path, count="*").help(
        "recording; folder that is searched for recordings at any depth; label table (.csv, "
        ".jsonl, .parquet) with its recordings beside it; rig file (.toml)"
    ),
    Option("--out TABLE", Path).help(
        "label table to write (default: the one that is named, else labels.csv where it is in "
        "the folder of recordings, else FOLDER-labels.csv beside it)"
    ),
    Option("--save-to FOLDER", Path).help(
        "where designs and votes are saved (default: beside the rig file, else beside the folder "
        "of recordings)"
    ),
    Option("--port PORT", whole_number(0, most=65535), 0).help(
        "to listen on (default: one that is free)"
    ),
    Option("--no-browser").help("print the address and open no browser"),
    Option("--samples N", whole_number(1)).help(
        "simulated samples that it learns from beside corrections, as of `bushing-noise "
        "train`; fewer are quicker and know less"
    ),
    seed("seed of simulated sounds and of random orders"),
)


def run(options: Namespace) -> int:
    """Serve until somebody asks it to stop."""
    from noise.app.opened import open_paths
    from noise.app.server import serve

    if options.save_to is not None:
        check_folder(options.save_to, "--save-to")
    opened = open_paths(options.paths, options.out, options.samples, options.seed, options.save_to)

    def ready(address: str) -> None:
        print(address, flush=True)
        if not options.no_browser:
            import webbrowser

            webbrowser.open(address)

    try:
        serve(opened, options.port, ready)
    except OSError as error:
        raise ParameterError(f"--port {options.port}: {error.strerror or error}") from None
    return 0

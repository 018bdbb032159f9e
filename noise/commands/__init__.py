"""Commands of ``bushing-noise``, one module each.

The module of a command has ``OPTIONS`` and ``run(options) -> int``, which returns the exit code.
Its description and the texts of its options are in ``help.toml``. Slow libraries are imported in
``run``, so that ``--help`` is fast. A new command needs a module, its texts and one line here.
"""

from __future__ import annotations

from importlib import import_module
from types import ModuleType

__all__ = ["COMMANDS", "load_command"]

COMMANDS = {
    "demo": "the whole chain on the rig's three noises and a silent run, with a report",
    "simulate": "one operating condition -> a recording",
    "render": "a recording or a condition -> an audible WAV",
    "features": "recordings -> a table of features",
    "label": "recordings -> a table of labelled segments",
    "screen": "bushing designs -> maps of which noise occurs where, margins, ranking",
    "frf": "hammer hits -> frequency response, coherence and modes",
    "diagnose": "recordings against the simulator -> which effect is missing, how much it explains",
    "identify": "recordings of a rig -> its rig file, with intervals",
    "review": "recordings and labels -> one page to look at and to listen to",
    "train": "build the classifier again from simulation",
    "open": "a local app: listen, correct labels, hear a design while it is changed, compare blind",
    "new-rig": "a commented rig file to start from",
    "effects": "the effects that a rig file can list, with their parameters",
    "materials": "the materials that are shipped, with their numbers",
    "thesis": "the published numbers beside what the program computes",
}
"""Commands and their one-line descriptions, in the order of the help."""


def load_command(name: str) -> ModuleType:
    """Import the module of a command.

    Examples
    --------
    >>> callable(load_command("train").run)
    True
    """
    return import_module(f"noise.commands.{name.replace('-', '_')}")

"""The commands of ``bushing-noise``, one file each.

A command is a module with ``configure(parser)``, which declares its options, and
``run(options) -> int``, which does the work and returns the exit code. What a module imports at
its top is what ``--help`` costs: the libraries that compute are imported in ``run``. A new command
is a file and one line here.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple, Protocol, cast

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace

__all__ = ["COMMANDS", "Command", "Entry", "load_command"]


class Command(Protocol):
    """What the module of a command offers."""

    def configure(self, parser: ArgumentParser) -> None:
        """Declare description and options."""
        ...

    def run(self, options: Namespace) -> int:
        """Do the work; return 0 where all is done, 1 where inputs were refused.

        Raises
        ------
        BushingNoiseError
            Options contradict each other, or nothing can be done with what they name.
        """
        ...


class Entry(NamedTuple):
    """Where a command lives, and what it does in one line."""

    module: str
    line: str


COMMANDS = {
    "demo": Entry(
        "noise.commands.demo",
        "the whole chain on the rig's three noises and a silent run, with a report",
    ),
    "simulate": Entry("noise.commands.simulate", "one operating condition -> a recording"),
    "render": Entry("noise.commands.render", "a recording or a condition -> an audible WAV"),
    "features": Entry("noise.commands.features", "recordings -> a table of features"),
    "label": Entry("noise.commands.label", "recordings -> a table of labelled segments"),
    "screen": Entry(
        "noise.commands.screen",
        "bushing designs -> maps of which noise occurs where, margins, ranking",
    ),
    "frf": Entry("noise.commands.frf", "hammer hits -> frequency response, coherence and modes"),
    "diagnose": Entry(
        "noise.commands.diagnose",
        "recordings against the simulator -> which effect is missing, and how far it closes",
    ),
    "identify": Entry(
        "noise.commands.identify", "recordings of a rig -> its rig file, with intervals"
    ),
    "review": Entry(
        "noise.commands.review",
        "recordings, labels, screens, diagnoses -> one page to look at and to listen to",
    ),
    "train": Entry("noise.commands.train", "build the classifier again from simulation"),
    "open": Entry(
        "noise.commands.open",
        "a local app: listen, correct labels, hear a design while it is changed, compare blind",
    ),
    "thesis": Entry(
        "noise.commands.thesis", "the published numbers beside what the program computes"
    ),
}
"""Name -> entry, in the order of the help."""


def load_command(name: str) -> Command:
    """Import the module of a command.

    Examples
    --------
    >>> callable(load_command("train").run)
    True
    """
    from importlib import import_module

    return cast("Command", import_module(COMMANDS[name].module))

"""The blocks of a section of the README, and what each of them is for."""

import re
from pathlib import Path
from typing import NamedTuple

README = Path(__file__).parents[2] / "README.md"


class Block(NamedTuple):
    """Lines that stand together: a file to save, commands, or Python."""

    kind: str
    name: str
    text: str

    @property
    def commands(self):
        """One list of arguments a line, without the name of the program."""
        return [line.split()[1:] for line in self.text.splitlines()]


def section(title):
    """Text of a section, from its heading to the next."""
    _, _, after = README.read_text(encoding="utf-8").partition(f"\n## {title}\n")
    return after.partition("\n## ")[0]


def blocks(text):
    """The indented blocks of a section; blank lines stand within files and Python."""
    parts = re.findall(r"(?:^ {4}.*\n(?:\n(?= {4}))*)+", text, re.MULTILINE)
    return [_block(piece) for part in parts for piece in _pieces(_flush_left(part))]


def _flush_left(part):
    return re.sub(r"^ {4}", "", part, flags=re.MULTILINE).strip() + "\n"


def _pieces(part):
    """Cut where a block of commands follows a file without a paragraph between them."""
    return re.split(r"(?<=\n)\n(?=bushing-noise )", part)


def _block(text):
    first = text.splitlines()[0]
    if named := re.fullmatch(r"# (\S+\.(?:toml|py))", first):
        return Block("file", named[1], text)
    if first.startswith("import noise"):
        return Block("python", "", text)
    lines = text.splitlines()
    assert all(line.startswith("bushing-noise ") for line in lines), f"neither of these: {text}"
    return Block("commands", "", text)


def paths(text):
    """Files that the prose of a section names."""
    prose = re.sub(r"^ {4}.*\n", "", text, flags=re.MULTILINE)
    return sorted(set(re.findall(r"`([\w./-]+\.(?:csv|png|html|json|wav))`", prose)))

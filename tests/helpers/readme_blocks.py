"""The blocks of the README and of the pages beside the code, and a walk through them."""

import contextlib
import io
import re
import shlex
import shutil
from pathlib import Path
from typing import NamedTuple

from noise.cli import main

ROOT = Path(__file__).parents[2]

README = ROOT / "README.md"

PAGES = [
    ROOT / folder / "README.md"
    for folder in (
        "models",
        "sim",
        *(
            f"noise/{one}"
            for one in ("app", "audio", "diagnosis", "labels", "recordings", "screening")
        ),
    )
]
"""Reference pages, each with blocks that run from an empty folder of its own."""

OUTPUTS = ("--out", "--plot", "--map", "--modes", "--sound-power")


class Block(NamedTuple):
    """Lines that stand together: a file to save, commands, a sidecar, or Python."""

    kind: str
    name: str
    text: str

    @property
    def commands(self):
        """One list of arguments a call, without the name of the program; pip and pytest apart."""
        calls = [shlex.split(part) for line in self.text.splitlines() for part in line.split("&&")]
        return [call[1:] for call in calls if call[0] == "bushing-noise"]


class Said(NamedTuple):
    """What a call came to."""

    line: list[str]
    code: int
    out: str
    err: str


def readme(title=None, page=README):
    """Text of a page, or of one of its sections, from the heading to the next."""
    text = page.read_text(encoding="utf-8")
    if title is None:
        return text
    return text.partition(f"\n## {title}\n")[2].partition("\n## ")[0]


def blocks(text):
    """The indented blocks; blank lines stand within files and Python."""
    parts = re.findall(r"(?:^ {4}.*\n(?:\n+(?= {4}))*)+", text, re.MULTILINE)
    return [_block(piece) for part in parts for piece in _pieces(_flush_left(part))]


def prose(text):
    """The text without its blocks, each paragraph in one line."""
    return re.sub(r"(?<=\S)\n(?=\S)", " ", re.sub(r"^ {4}.*\n", "", text, flags=re.MULTILINE))


def paths(text):
    """Files that the prose names with a folder."""
    return sorted(
        set(re.findall(r"`([\w.-]+/[\w./-]+\.(?:csv|png|html|json|wav|toml))`", prose(text)))
    )


def quoted(text):
    """What the prose says that a command prints."""
    return re.findall(r"(?<!\*)\*([^*\n]+)\*(?!\*)", prose(text))


SERVING = ("open",)
"""Commands that go on until they are stopped: they have tests of their own."""


def walk(folder, dear=(), page=README, demo=None):
    """Run all blocks of a page in a folder, but the commands named, and what needs their output.

    A folder `demo` of that command is copied where a page calls it.
    """
    said, lacking = [], set()
    with contextlib.chdir(folder):
        for block in blocks(readme(page=page)):
            if block.kind == "commands":
                for line in block.commands:
                    if line[0] in (*dear, *SERVING) or _needs(line[1:], lacking):
                        lacking |= _made(line)
                    elif line[0] == "demo" and demo is not None:
                        shutil.copytree(demo, line[line.index("--out") + 1])
                    else:
                        said.append(_call(line))
            elif _needs(re.findall(r'"([^"]*)"', block.text), lacking):
                lacking.add(block.name)
            elif block.kind == "python":
                exec(compile(block.text, "README.md", "exec"), {"__name__": "__main__"})
            elif block.kind == "file":
                Path(block.name).write_text(block.text, encoding="utf-8")
    return said


def _call(line):
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        code = main(line)
    return Said(line, code, out.getvalue(), err.getvalue())


def _made(line):
    """Folder or file that a call writes."""
    values = [line[i + 1] for i, word in enumerate(line) if word in OUTPUTS]
    return {value.split("/")[0] for value in values}


def _needs(words, lacking):
    return any(word.split("/")[0] in lacking for word in words)


def _flush_left(part):
    return re.sub(r"^ {4}", "", part, flags=re.MULTILINE).strip() + "\n"


def _pieces(part):
    """Cut where files and commands follow one another without a paragraph between them."""
    return re.split(r"(?<=\n)\n(?=bushing-noise |# \S+\.(?:toml|py)\n)", part)


def _block(text):
    first = text.splitlines()[0]
    if named := re.fullmatch(r"# (\S+\.(?:toml|py))", first):
        return Block("file", named[1], text)
    if first.startswith("{"):
        return Block("sidecar", "", text)
    if first.startswith("import noise"):
        return Block("python", "", text)
    starts = ("bushing-noise ", "python -m pip install ")
    assert all(line.startswith(starts) for line in text.splitlines()), f"neither of these: {text}"
    return Block("commands", "", text)

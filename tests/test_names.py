"""Names of data, parameters, functions and classes are nouns of the field, not past participles."""

import ast
from pathlib import Path

ROOT = Path(__file__).parents[1]
SOURCES = [
    path for top in ("models", "sim", "features", "noise") for path in (ROOT / top).rglob("*.py")
]
VAGUE = {"told", "said", "kept", "heard", "found", "asked", "tried", "seen"}
"""Words that tell what happened to a value instead of what it is."""

PUBLISHED = {"not_found"}
"""Keys of `identification.json`, which others read."""


def defined_names(tree):
    for node in ast.walk(tree):
        match node:
            case ast.FunctionDef() | ast.ClassDef():
                yield node.name
            case ast.arg():
                yield node.arg
            case ast.Name(ctx=ast.Store()):
                yield node.id
            case ast.Attribute(ctx=ast.Store()):
                yield node.attr


def vague_names(source):
    names = {*defined_names(ast.parse(source))} - PUBLISHED
    return {name for name in names if VAGUE & {*name.lower().split("_")}}


def test_names_say_what_a_value_is():
    vague = {str(path.relative_to(ROOT)): vague_names(path.read_text("utf-8")) for path in SOURCES}
    assert {path: names for path, names in vague.items() if names} == {}


def test_vague_names_are_recognised():
    source = "def kept_rows(heard):\n    found = heard\n    self._told = found\n    rows = found"
    assert vague_names(source) == {"kept_rows", "heard", "found", "_told"}

"""Every public number says its unit, every public array its shape."""

from __future__ import annotations

import ast
import re
from pathlib import Path

from numpydoc.docscrape import NumpyDocString

ROOT = Path(__file__).parents[1]
MODULES = sorted(
    path.relative_to(ROOT)
    for package in ("models", "sim", "features", "noise")
    for path in (ROOT / package).rglob("*.py")
    if not any(
        path.is_relative_to(ROOT / "noise" / recipes)
        for recipes in (
            "diagnosis/cases",
            "training/causes/cases",
            "training/classifier/background_sounds.py",
            "training/classifier/places.py",
            "training/classifier/recorder.py",
            "training/classifier/synthesis.py",
        )
    )  # rows of tables, whose common signature is described once
)
SECTIONS = ("Parameters", "Other Parameters", "Returns", "Yields", "Attributes")
UNIT = re.compile(r"\[[^\]\[]+\]")
"""Such as [Hz] or [Nm s/rad]; [-] is a number without one."""

PURE = re.compile(
    r"\b(shares?|ratios?|factors?|relative|probabilit\w+|fractions?|exponent|coherence|quantiles?|"
    r"logarithms?|correlation|score|weights?|p-value|confidence|strength|number of|times|index|"
    r"indices|samples|lines|octaves?|floors|seed)\b|%|\bdB\b|degree",
    re.IGNORECASE,
)
"""Words for what has no unit, or names one."""

ELSEWHERE = re.compile(r"\bAs (for|of|in|to)\b|as `", re.IGNORECASE)
"""Described where it is described already."""


def documented(tree):
    """Public functions and classes, and public methods of these, by name."""
    for node in tree.body:
        if isinstance(node, ast.FunctionDef | ast.ClassDef) and not node.name.startswith("_"):
            yield node.name, node
            for member in node.body if isinstance(node, ast.ClassDef) else ():
                if isinstance(member, ast.FunctionDef) and not member.name.startswith("_"):
                    yield f"{node.name}.{member.name}", member


def says_unit(text):
    return any(pattern.search(text) for pattern in (UNIT, PURE, ELSEWHERE))


def says_shape(text):
    return "shape" in text or bool(ELSEWHERE.search(text))


def lacking_in_sections(sections):
    """Entries of a numpydoc text that lack a unit or a shape."""
    for section in SECTIONS:
        for name, kind, lines in sections[section]:
            said = " ".join([kind, *lines])
            if "ndarray" in kind and not says_shape(said):
                yield f"{name or kind}: shape"
            plain = "ndarray" not in kind or not re.search("bool|int|complex|str", kind)
            if re.search(r"\bfloats?\b|ndarray", kind) and plain and not says_unit(said):
                yield f"{name or kind}: unit"


def lacking_in_text(function, text, sections):
    """Arguments and results of a function, told in its text alone, that lack a unit or a shape."""
    arguments = [*function.args.args, *function.args.kwonlyargs]
    told = {argument.arg: argument.annotation for argument in arguments if argument.annotation}
    if sections["Parameters"]:
        told = {}
    if not sections["Returns"] and not sections["Yields"] and function.returns is not None:
        told["result"] = function.returns
    for name, annotation in told.items():
        kind = ast.unparse(annotation)
        if re.search(r"NDArray\[np.float64\]|\bArray\b", kind) and not says_shape(text):
            yield f"{name}: shape"
        elif re.fullmatch(r"float( \| None)?", kind) and not says_unit(text):
            yield f"{name}: unit"


def test_public_numbers_have_units_and_arrays_have_shapes():
    lacking = []
    for module in MODULES:
        for name, node in documented(ast.parse((ROOT / module).read_text(encoding="utf-8"))):
            text = ast.get_docstring(node) or ""
            sections = NumpyDocString(text)
            found = list(lacking_in_sections(sections))
            if isinstance(node, ast.FunctionDef):
                found += lacking_in_text(node, text, sections)
            lacking += [f"{module}: {name}, {what}" for what in found]
    assert len(MODULES) > 100
    assert lacking == []

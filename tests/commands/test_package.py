"""The package as a notebook imports it: light, listed, documented, with examples that run."""

import dataclasses
import importlib
import inspect
import os
import re
import subprocess
import sys

import pytest

import noise

PUBLIC = [
    (package, name)
    for package in ("noise", "sim", "features")
    for name in importlib.import_module(package).__all__
]


def has_section(documented, *names):
    return any(re.search(rf"^{name}\n-+$", documented, re.MULTILINE) for name in names)


def lacking(function):
    """Sections that a function's documentation needs and does not have."""
    documented = inspect.getdoc(function) or ""
    signature = inspect.signature(function)
    raises = re.search(r"^    raise ", inspect.getsource(function), re.MULTILINE)
    needed = {
        "Parameters": [name for name in signature.parameters if name != "self"],
        "Returns": signature.return_annotation not in (None, "None"),
        "Raises": raises,
    }
    there = {"Returns": ("Returns", "Yields")}
    return [
        section
        for section, asked in needed.items()
        if asked and not has_section(documented, *there.get(section, (section,)))
    ]


def own_methods(kind):
    for name, member in vars(kind).items():
        plain = getattr(member, "__func__", getattr(member, "fget", member))
        if not name.startswith("_") and inspect.isfunction(plain):
            yield name, plain


@pytest.mark.parametrize(("package", "name"), PUBLIC)
def test_a_public_name_is_documented(package, name):
    value = getattr(importlib.import_module(package), name)
    if package != "noise" and name in noise.__all__:
        assert value is getattr(noise, name)
    documented = inspect.getdoc(value) or ""
    if inspect.isfunction(value):
        assert documented.splitlines()[0].endswith((".", ":"))
        assert lacking(value) == []
        assert ">>> " in documented
    elif inspect.isclass(value):
        assert documented.splitlines()[0].endswith((".", ":"))
        if dataclasses.is_dataclass(value) and dataclasses.fields(value):
            assert has_section(documented, "Parameters")
        if package == "noise" and not issubclass(value, Exception):
            assert ">>> " in documented
        for called, method in own_methods(value):
            assert inspect.getdoc(method), called
            assert called != "plot" or lacking(method) == []


def test_the_package_lists_each_of_its_names_once():
    *groups, _ = noise.__doc__.split("Results have a short")
    listed = re.findall(r"`(\w+)`", "".join(groups))
    assert sorted(listed) == sorted(noise.__all__)
    with pytest.raises(AttributeError, match="nonsense"):
        _ = noise.nonsense


def imported(tmp_path, code="import noise"):
    environment = {**os.environ, "PYTHONPATH": str(tmp_path)}
    return subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, env=environment, capture_output=True,
        text=True, check=False,
    )  # fmt: skip


@pytest.mark.parametrize("hiding", ["models.py", "features/__init__.py"])
def test_a_users_file_or_folder_that_hides_a_package_is_named(tmp_path, hiding):
    path = tmp_path / hiding
    path.parent.mkdir(exist_ok=True)
    path.write_text("x = 1\n", encoding="utf-8")
    result = imported(tmp_path)
    assert result.returncode != 0
    last = result.stderr.strip().splitlines()[-1]
    assert f"hides the package {hiding.partition('/')[0].removesuffix('.py')!r}" in last
    assert "rename it" in last


def test_import_is_light_whatever_else_the_folder_holds(tmp_path):
    (tmp_path / "model.py").write_text("x = 1\n", encoding="utf-8")
    heavy = "{'numpy', 'scipy', 'sklearn', 'librosa', 'matplotlib', 'numba'}"
    code = f"import noise, sys; assert not {heavy} & set(sys.modules)"
    assert imported(tmp_path, code).returncode == 0

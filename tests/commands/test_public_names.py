"""What can be imported is listed, documented, and shown by an example that runs."""

import dataclasses
import importlib
import inspect
import re

import pytest

import noise

PUBLIC = [
    (package, name)
    for package in ("noise", "sim", "features")
    for name in importlib.import_module(package).__all__
]
SECTION = r"^{}\n-+$"


def has_section(documented, *names):
    return any(re.search(SECTION.format(name), documented, re.MULTILINE) for name in names)


def own_methods(kind):
    for name, member in vars(kind).items():
        if not name.startswith("_"):
            plain = getattr(member, "__func__", getattr(member, "fget", member))
            if inspect.isfunction(plain):
                yield name, plain


def functions_of(value):
    """The function itself, or the methods of a class, each with what it is called."""
    if inspect.isfunction(value):
        return [(value.__name__, value)]
    return list(own_methods(value)) if inspect.isclass(value) else []


def lacking(function):
    """Sections that a function's documentation needs and does not have."""
    documented = inspect.getdoc(function) or ""
    signature = inspect.signature(function)
    parameters = [name for name in signature.parameters if name != "self"]
    returned = signature.return_annotation
    lacks = []
    if parameters and not has_section(documented, "Parameters"):
        lacks.append("Parameters")
    if returned not in (None, "None") and not has_section(documented, "Returns", "Yields"):
        lacks.append("Returns")
    if re.search(r"^    raise ", inspect.getsource(function), re.MULTILINE) and not has_section(
        documented, "Raises"
    ):
        lacks.append("Raises")
    return lacks


@pytest.mark.parametrize(("package", "name"), PUBLIC)
def test_a_public_name_is_there_and_what_it_is_called_with_is_documented(package, name):
    value = getattr(importlib.import_module(package), name)
    if not (inspect.isfunction(value) or inspect.isclass(value)):
        return  # a constant: its text stands below it, for readers of the module
    documented = inspect.getdoc(value) or ""
    assert documented.splitlines()[0].endswith((".", ":")), "begins with one sentence"
    if inspect.isfunction(value):
        assert lacking(value) == []
    elif dataclasses.is_dataclass(value) and dataclasses.fields(value):
        assert has_section(documented, "Parameters")
    for called, method in functions_of(value):
        assert inspect.getdoc(method), called


@pytest.mark.parametrize(("package", "name"), PUBLIC)
def test_a_public_function_has_an_example(package, name):
    value = getattr(importlib.import_module(package), name)
    if inspect.isfunction(value):
        assert ">>> " in inspect.getdoc(value)


@pytest.mark.parametrize("name", noise.__all__)
def test_what_a_notebook_imports_has_an_example(name):
    value = getattr(noise, name)
    if inspect.isclass(value) and not issubclass(value, Exception):
        assert ">>> " in inspect.getdoc(value)


@pytest.mark.parametrize("name", noise.__all__)
def test_methods_of_what_a_notebook_imports_say_what_they_take_and_return(name):
    value = getattr(noise, name)
    if inspect.isclass(value):
        drawn = [method for called, method in own_methods(value) if called == "plot"]
        assert [lacking(method) for method in drawn] == [[] for _ in drawn]


def test_the_package_lists_each_of_its_names_once():
    *groups, _ = noise.__doc__.split("Results print themselves")
    listed = re.findall(r"`(\w+)`", "".join(groups))
    assert sorted(listed) == sorted(noise.__all__)


def test_a_name_stands_for_the_same_thing_in_all_packages():
    for package, name in PUBLIC:
        if package != "noise" and name in noise.__all__:
            assert getattr(importlib.import_module(package), name) is getattr(noise, name)

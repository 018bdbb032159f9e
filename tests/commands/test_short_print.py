"""Whatever a notebook prints is short, however much it holds."""

import dataclasses
import importlib
import inspect
import pkgutil
import re
import warnings

import numpy as np
import pytest

import features
import models
import noise
import sim
from noise.labels.segments import Segment

LONGEST = 500

PACKAGES = (noise, sim, features, models)


def dataclasses_by_name():
    found = {}
    for package in PACKAGES:
        for module in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
            if re.search(r"training|__main__|commands|\.app", module.name):
                continue
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                members = vars(importlib.import_module(module.name))
            for value in members.values():
                ours = inspect.isclass(value) and value.__module__ == module.name
                if ours and dataclasses.is_dataclass(value):
                    found[value.__name__] = value
    return found


def names_in(annotation):
    return re.findall(r"[A-Z]\w+", kind_of(annotation))


def kind_of(annotation):
    """The type in words, without what else is declared beside it."""
    return str(annotation.__origin__ if hasattr(annotation, "__metadata__") else annotation)


def public():
    """Dataclasses that are exported or returned by what is, and all that these hold."""
    found = dataclasses_by_name()
    there = [
        getattr(package, name) for package in PACKAGES for name in getattr(package, "__all__", ())
    ]
    left = [one.__name__ for one in there if inspect.isclass(one)]
    for one in there:
        if inspect.isfunction(one):
            left += names_in(one.__annotations__.get("return", ""))
    reached = {}
    while left:
        name = left.pop()
        if name in found and name not in reached:
            reached[name] = found[name]
            for field in dataclasses.fields(found[name]):
                left += names_in(field.type)
    return reached


PUBLIC = public()
WITH_ARRAYS = [
    name
    for name, cls in sorted(PUBLIC.items())
    if any("NDArray" in str(field.type) for field in dataclasses.fields(cls))
]


def filled(cls, depth=0):
    """An instance whose arrays, tables and texts are long, and that nobody could have made."""
    one = object.__new__(cls)
    for field in dataclasses.fields(cls):
        object.__setattr__(one, field.name, _long(kind_of(field.type), depth))
    return one


def _long(annotation, depth):
    inner = next((PUBLIC[name] for name in names_in(annotation) if name in PUBLIC), None)
    if annotation.startswith(("tuple", "Sequence", "list")):
        item = 1.5 if inner is None or depth > 2 else filled(inner, depth + 1)
        return (item,) * 300
    if annotation.startswith(("Mapping", "dict")):
        return {f"name {n}": np.zeros(500) for n in range(300)}
    if "NDArray" in annotation:
        return np.zeros((30, 500))
    if inner is not None and depth < 3:
        return filled(inner, depth + 1)
    return 1.5 if "float" in annotation else "text"


def test_there_are_dataclasses_with_arrays_to_look_at():
    assert {"Recording", "Run", "Motion", "TransferFunction", "Modes"} <= set(WITH_ARRAYS)


@pytest.mark.parametrize("name", sorted(set(PUBLIC) - {"LawSpec"}))
def test_what_is_public_prints_short_whatever_it_holds(name):
    one = filled(PUBLIC[name])
    for words in {repr(one), str(one)}:
        assert len(words) <= LONGEST
        assert "\n" not in words
    assert repr(one).startswith(f"{name}(")


def test_a_law_says_all_its_parameters_which_tell_it_from_others():
    for material in noise.material_names():
        rig = noise.load_material_rig(material)
        for law in (rig.friction, *rig.effects):
            assert len(repr(law)) <= LONGEST
            assert all(repr(value) in repr(law) for value in law.parameters.values())


def test_public_classes_that_are_no_dataclasses_print_short():
    rig = noise.load_material_rig("PDMS")
    logged = noise.LoggedSpeed(np.arange(5000.0), np.linspace(0.0, 12.0, 5000))
    assert repr(logged) == "LoggedSpeed(5000 samples, 0 to 4999 s, 0 to 12 rad/s)"
    made = (
        logged,
        features.RecordingFeatures(),
        noise.Inferred(interference=noise.Interval(2.8e-4, 2.5e-4, 3.1e-4)),
        noise.sweep(rig, np.linspace(1.0, 9.0, 50), seconds=0.01),
        noise.Segments([]),
        noise.LabelTable([]),
        *(noise.ParameterError("what, where"), noise.RecordingError("what, where")),
    )
    for one in made:
        assert len(repr(one)) <= LONGEST
        assert len(str(one)) <= LONGEST
    told = {type(one).__name__ for one in made} | set(PUBLIC)
    left = {
        getattr(package, name).__name__
        for package in PACKAGES
        for name in getattr(package, "__all__", ())
        if inspect.isclass(getattr(package, name))
    } - told
    # A base class, two protocols, and two whose members are named and nothing else.
    assert left == {"BushingNoiseError", "ShaftMotion", "Regime", "WindowFeature"}


def test_a_run_a_rig_and_a_classifier_print_short():
    rig = noise.load_material_rig("fluorocarbon")
    run = noise.simulate(rig, 5.0)
    for one in (rig, run, run.recording, run.motion, noise.load_classifier()):
        assert len(repr(one)) <= LONGEST
    assert "2 x" not in repr(run.recording) or "float" in repr(run.recording)


def test_tables_print_what_is_in_them_and_not_their_rows():
    rows = [{"file": f"{n}.wav", "label": "creak"} for n in range(1000)]
    assert repr(noise.LabelTable(rows)) == "LabelTable(1000 files; segments: 1000 creak)"
    found = noise.Segments(
        [Segment("all", n, n + 1.0, "none", {}, None, None, None) for n in range(99)]
    )
    assert repr(found).startswith("Segments(99: none 0 to 1 s, ")
    assert len(repr(found)) < LONGEST

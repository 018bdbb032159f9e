"""bushing-noise: simulate, hear, label and explain the noise of a rubber bushing.

>>> import noise
>>> rig = noise.load_material_rig("fluorocarbon")
>>> run = noise.simulate(rig, 10.0, interference=0.279e-3, support_stiffness=3745.0)
>>> [segment.label for segment in noise.label_recording(run.recording, noise.load_classifier())]
['squeal']

Simulate: `load_rig`, `load_material_rig`, `material_names`, `simulate`, `Run`, `Acquisition`,
`Sensors`, `Sensor`, `ConstantSpeed`, `SpeedRamp`, `Oscillation`, `LoggedSpeed`, `Condition`,
`FIXED`.

Listen: `find_recordings`, `read_recording`, `read_calibrator`, `write_recording`,
`Recording`, `Channel`, `plot_run`, `write_picture`.

Label: `label`, `LabelTable`, `label_recording`, `file_label`, `Segment`, `LABELS`,
`Classifier`, `load_classifier`, `train`, `Inference`, `Interval`, `load_inference`,
`train_inference`.

Screen: `screen`, `Screening`, `load_design`, `Design`, `Use`, `Swinging`, `sweep`, `Sweep`,
`plot_screen`, `critical_speeds`, `critical_damping`.

Diagnose: `diagnose`, `Diagnosis`.

Identify: `identify`, `Identification`.

Review: `review`, `Review`.

Errors: `BushingNoiseError`, `ParameterError`, `RecordingError`.

Results have a short ``repr``; tables have a method ``to_pandas``, and results with a picture a
method ``plot`` that returns matplotlib axes. Names are imported on first use, so that
``import noise`` is fast.
"""

from __future__ import annotations

from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any

_EXPORTS = {
    "models.condition": ("FIXED", "Condition"),
    "models.errors": ("BushingNoiseError", "ParameterError", "RecordingError"),
    "models.recording": ("Channel", "Recording"),
    "models.rig_file": ("load_material_rig", "load_rig", "material_names"),
    "models.sensors": ("Sensor", "Sensors"),
    "noise.classifier": ("LABELS", "Classifier", "load_classifier"),
    "noise.training.classifier.fit": ("train",),
    "noise.diagnosis.outcome": ("Diagnosis",),
    "noise.diagnosis.diagnose": ("diagnose",),
    "noise.identification.outcome": ("Identification",),
    "noise.identification.identify": ("identify",),
    "noise.inference": ("Inference", "Interval", "load_inference"),
    "noise.training.inference": ("train_inference",),
    "noise.labels.segments": ("Segment", "file_label", "label_recording"),
    "noise.labels.table": ("LabelTable",),
    "noise.labels.labelling": ("label",),
    "noise.pictures.figure": ("write_picture",),
    "noise.pictures.run": ("plot_run",),
    "noise.pictures.maps": ("plot_screen",),
    "noise.recordings.calibrator": ("read_calibrator",),
    "noise.recordings": ("find_recordings", "read_recording", "write_recording"),
    "noise.screening.design": ("Design", "Swinging", "Use", "load_design"),
    "noise.screening.screen": ("Screening", "screen"),
    "noise.pages.review": ("Review", "review"),
    "sim.acquisition": ("Acquisition",),
    "sim.analysis.critical_speeds": ("critical_damping", "critical_speeds"),
    "sim.run": ("Run", "simulate"),
    "sim.shaft": ("ConstantSpeed", "LoggedSpeed", "Oscillation", "SpeedRamp"),
    "sim.analysis.sweep": ("Sweep", "sweep"),
}
"""Public names by module."""

_MODULE_OF = {name: module for module, names in _EXPORTS.items() for name in names}

__all__ = sorted(_MODULE_OF)


def __getattr__(name: str) -> Any:
    """Import a public name on first use."""
    if name == "__version__":
        from importlib.metadata import version

        return version("bushing-noise")
    if name not in _MODULE_OF:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(_MODULE_OF[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return __all__


def _refuse_hidden_packages() -> None:
    """Raise an error if a user's file hides one of the packages."""
    root = Path(__file__).resolve().parent.parent
    for name in ("models", "sim", "features"):
        spec = find_spec(name)
        if spec is not None:
            place = next(iter(spec.submodule_search_locations or ()), spec.origin)
            if Path(str(place)).resolve() != root / name:
                raise ImportError(
                    f"{place} hides the package {name!r} of bushing-noise; rename it, or work in a "
                    f"folder without it"
                )


_refuse_hidden_packages()
import_module("models")  # sets the cache folder of compiled code before anything is compiled

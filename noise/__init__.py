"""bushing-noise: simulate, hear, label and explain the noise of a rubber bushing.

>>> import noise
>>> rig = noise.load_material_rig("fluorocarbon")
>>> run = noise.simulate(rig, 10.0, interference=0.279e-3, support_stiffness=3745.0)
>>> [segment.label for segment in noise.label_recording(run.recording, noise.load_classifier())]
['squeal']

Simulate: `load_rig`, `load_material_rig`, `material_names`, `simulate`, `Run`, `Acquisition`,
`Sensors`, `Sensor`, `ConstantSpeed`, `SpeedRamp`, `Oscillation`, `LoggedSpeed`, `Condition`,
`FIXED`.

Listen: `find_recordings`, `read_recording`, `read_calibrator`, `Calibration`, `write_recording`,
`Recording`, `Channel`, `plot_run`, `write_picture`.

Label: `label`, `LabelTable`, `label_recording`, `file_label`, `Segment`, `Segments`, `LABELS`,
`Classifier`, `load_classifier`, `train`, `Inference`, `Inferred`, `Interval`, `load_inference`,
`train_inference`.

Screen: `screen`, `Screening`, `load_design`, `Design`, `Use`, `Swinging`, `sweep`, `Sweep`,
`plot_screen`, `robustness`, `Robustness`, `critical_speeds`, `critical_damping`.

Diagnose: `diagnose`, `Diagnosis`.

Identify: `identify`, `Identification`.

Review: `review`, `Review`, `write_report`, `ReportEntry`.

What goes wrong: `BushingNoiseError`, `ParameterError`, `RecordingError`.

Results print themselves in a line or two; tables have a ``to_pandas``, and what says something as a
picture has a ``plot`` that returns the axes of matplotlib. Names are loaded when they are first
used, so that ``import noise`` itself is quick.
"""

from __future__ import annotations

from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any

_EXPORTS = {
    "models.calibration": ("Calibration",),
    "models.condition": ("FIXED", "Condition"),
    "models.errors": ("BushingNoiseError", "ParameterError", "RecordingError"),
    "models.recording": ("Channel", "Recording"),
    "models.rig_file": ("load_material_rig", "load_rig", "material_names"),
    "models.sensors": ("Sensor", "Sensors"),
    "noise.classifier": ("LABELS", "Classifier", "load_classifier"),
    "noise.training.classifier.fit": ("train",),
    "noise.diagnosis.outcome": ("Diagnosis",),
    "noise.diagnosis.run": ("diagnose",),
    "noise.identification.outcome": ("Identification",),
    "noise.identification.identify": ("identify",),
    "noise.inference": ("Inference", "Inferred", "Interval", "load_inference"),
    "noise.training.inference.fit": ("train_inference",),
    "noise.labels.segments": ("Segment", "Segments", "file_label", "label_recording"),
    "noise.labels.table": ("LabelTable",),
    "noise.labels.labelling": ("label",),
    "noise.pictures.figure": ("write_picture",),
    "noise.pictures.run": ("plot_run",),
    "noise.pictures.maps": ("plot_screen",),
    "noise.recordings.calibrator": ("read_calibrator",),
    "noise.recordings": ("find_recordings", "read_recording", "write_recording"),
    "noise.screening.design": ("Design", "Swinging", "Use", "load_design"),
    "noise.screening.parts": ("Robustness", "robustness"),
    "noise.screening.screen": ("Screening", "screen"),
    "noise.pages.report": ("ReportEntry", "write_report"),
    "noise.pages.review": ("Review", "review"),
    "sim.acquisition": ("Acquisition",),
    "sim.analysis.critical_damping": ("critical_damping",),
    "sim.analysis.critical_speeds": ("critical_speeds",),
    "sim.run": ("Run", "simulate"),
    "sim.shaft": ("ConstantSpeed", "LoggedSpeed", "Oscillation", "SpeedRamp"),
    "sim.analysis.sweep": ("Sweep", "sweep"),
}
"""What a notebook finds here, by the module it lives in."""

_HOME = {name: module for module, names in _EXPORTS.items() for name in names}

__all__ = sorted(_HOME)


def __getattr__(name: str) -> Any:
    if name == "__version__":
        from importlib.metadata import version

        return version("bushing-noise")
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(_HOME[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return __all__


def _refuse_hidden_packages() -> None:
    """Say so where a file of the user's own has the name of one of our packages."""
    ours = Path(__file__).resolve().parent.parent
    for name in ("models", "sim", "features"):
        spec = find_spec(name)
        if spec is None:
            raise ImportError(
                f"package {name!r} of bushing-noise is missing; install bushing-noise again",
                name=name,
            )
        places = [spec.origin] if spec.origin else list(spec.submodule_search_locations or ())
        found = Path(places[0]).resolve()
        if ours / name not in (found, found.parent):
            raise ImportError(
                f"{found} hides the package {name!r} of bushing-noise; rename it, or work in a "
                f"folder without it",
                name=name,
                path=str(found),
            )


_refuse_hidden_packages()
import_module("models")  # names the folder for compiled code, before anything is compiled

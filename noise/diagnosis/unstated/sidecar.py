"""What a user is asked to write where a condition is not stated and nothing tells it."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import PurePath

from models.condition import FIXED, Condition
from models.recording import Recording
from noise.recordings.sidecar import sidecar_text


def sidecar_request(
    recording: Recording, interferences: Sequence[float], supports: Sequence[float]
) -> str:
    """Return the sidecar that a recording lacks, in one line, and what can stand in it.

    Parameters
    ----------
    recording : Recording
        Named as its file; its condition as far as it is known.
    interferences : sequence of float
        Of the rig's fits [m].
    supports : sequence of float
        Of the rig [Nm/rad] or `models.condition.FIXED`.

    Returns
    -------
    str

    Examples
    --------
    >>> import numpy as np
    >>> from models.recording import Channel
    >>> from models.recording import Recording
    >>> run = Recording(np.zeros((1, 8)), 48e3, (Channel("pressure"),), name="run03.wav")
    >>> print(sidecar_request(run, [0.000178, 0.000279], [2214.0, FIXED]))
    write run03.json with your own numbers: {"channels": [{"name": "pressure", "unit": "Pa"}],
      "conditions": {"speed_rad_s": 1.0, "interference_mm": 0.178,
      "support_stiffness_Nm_rad": 2214.0}, "calibrated": true}; interference_mm is 0.178 or 0.279,
      support_stiffness_Nm_rad 2214 or null (clamp bolted to the baseplate)
    """
    at = recording.condition
    filled = Condition(
        1.0 if not at.speed else at.speed,
        at.interference or interferences[0],
        at.support_stiffness or supports[0],
        at.material,
        at.temperature,
    )
    full = sidecar_text(replace(recording, condition=filled, calibrated=True, notes=()))
    name = PurePath(recording.name).with_suffix(".json").name if recording.name else "its sidecar"
    choices = [
        f"interference_mm is {_either([f'{1e3 * x:.4g}' for x in interferences])}",
        f"support_stiffness_Nm_rad {_either([_support(x) for x in supports])}",
    ]
    return (
        f"write {name} with your own numbers: {json.dumps(json.loads(full))}; {', '.join(choices)}"
    )


def _support(stiffness: float) -> str:
    return "null (clamp bolted to the baseplate)" if stiffness == FIXED else f"{stiffness:g}"


def _either(choices: Sequence[str]) -> str:
    return choices[0] if len(choices) == 1 else f"{', '.join(choices[:-1])} or {choices[-1]}"

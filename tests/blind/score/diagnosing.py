"""Diagnose cases, each copied to a folder whose name and place tell nothing, answers out of reach.

A diagnosis is a function of the folder of data and the path of the rig file, found by its name
``module:function``, or a baseline.
"""

from __future__ import annotations

import importlib
import shutil
import sys
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

__all__ = ["DIAGNOSE", "diagnose_copy", "resolve"]

DIAGNOSE = "noise.diagnosis.run:diagnosis_json"
"""What ``bushing-noise diagnose`` calls."""


def resolve(name: str) -> Callable[[Path, Path], Mapping]:
    """Find a function by ``module:function``.

    Raises
    ------
    SystemExit
        There is none; the message says what to give instead.
    """
    module, _, function = name.partition(":")
    try:
        return getattr(importlib.import_module(module), function)
    except (ImportError, AttributeError, ValueError) as error:
        raise SystemExit(
            f"--diagnose {name}: there is no such function ({error}); give MODULE:FUNCTION that "
            "takes a folder and a rig file, or --baseline none, random or oracle"
        ) from None


def diagnose_copy(job: tuple[str, Path, bool]) -> Mapping | None:
    """Diagnose a copy of a case; None where that fails, which standard error then says.

    ``seconds`` is measured here where the diagnosis does not say it.
    """
    name, case, quick = job
    diagnose = resolve(name)
    with tempfile.TemporaryDirectory() as away:
        copy = shutil.copytree(case, Path(away) / "case")
        begun = time.perf_counter()
        try:
            options = {"quick": True} if quick else {}
            said = dict(diagnose(copy, copy / "rig.toml", **options))
        except Exception as error:
            sys.stderr.write(f"{case.name}: {type(error).__name__}: {error}\n")
            return None
        return {"seconds": time.perf_counter() - begun} | said

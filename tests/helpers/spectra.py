"""Spectra of the four impulse responses, at frequencies that need be those of no transform."""

from __future__ import annotations

from dataclasses import fields
from types import SimpleNamespace

import numpy as np

__all__ = ["path_spectra"]


def path_spectra(paths, frequencies):
    """Sums of h[n] exp(-i omega n / rate), named as the impulse responses are."""
    angle = -2j * np.pi * np.asarray(frequencies, dtype=np.float64) / paths.rate
    found = {}
    for name in (field.name for field in fields(paths) if field.name != "rate"):
        h = getattr(paths, name)
        found[name] = sum(
            h[i : i + 2048] @ np.exp(np.outer(np.arange(i, min(i + 2048, h.size)), angle))
            for i in range(0, h.size, 2048)
        )
    return SimpleNamespace(**found)

"""Spectra of the four impulse responses, at frequencies that need be those of no transform."""

from __future__ import annotations

import math
from dataclasses import fields
from types import SimpleNamespace

import numpy as np

__all__ = ["path_spectra"]


def path_spectra(paths, frequencies):
    """Sums of h[n] exp(-i omega n / rate), named as the impulse responses are."""
    angle = 2 * np.pi * np.asarray(frequencies, dtype=np.float64) / paths.rate
    names = (field.name for field in fields(paths) if field.name != "rate")
    return SimpleNamespace(**{name: _transform(getattr(paths, name), angle) for name in names})


def _transform(impulse_response, angle):
    """In rows of samples and a sum over the rows, which takes the root of the exponentials."""
    row = math.isqrt(impulse_response.size) + 1
    rows = np.zeros((row, row))
    rows.ravel()[: impulse_response.size] = impulse_response
    within = np.exp(-1j * np.outer(np.arange(row), angle))
    between = np.exp(-1j * np.outer(np.arange(row) * row, angle))
    return np.sum(between * (rows @ within), axis=0)

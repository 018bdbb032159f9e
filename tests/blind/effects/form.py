"""What a form of an effect is: a function that changes a `Setup`, known by effect and set.

Development and sealed set have different forms of each effect. `case` is a generator that starts
alike in all recordings of a case (what the effect is), `run` one of the recording (its chance).
A strength of 0 leaves the setup alone; 1 is strong.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from ..rig import Setup

__all__ = ["DEVELOPMENT", "FORMS", "SEALED", "Form", "form", "noise_in_band"]

DEVELOPMENT, SEALED = "development", "sealed"


@dataclass(frozen=True)
class Form:
    """One functional form of one effect; `stage` is where it acts."""

    effect: str
    name: str
    stage: str
    kept_for: str
    change: Callable[[Setup, float, np.random.Generator, np.random.Generator], None]

    def apply(self, setup: Setup, strength: float, case, run) -> None:
        """Change the setup."""
        if strength > 0.0:
            self.change(setup, strength, case, run)


FORMS: dict[tuple[str, str], Form] = {}
"""By effect and name of the form."""


def form(effect: str, stage: str, kept_for: str):
    """Enter a function as a form of an effect."""

    def enter(change):
        FORMS[effect, change.__name__] = Form(effect, change.__name__, stage, kept_for, change)
        return change

    return enter


def noise_in_band(rng, n, rate, low, high, tilt=0.0):
    """Gaussian noise of unit rms between two frequencies, its power falling as f**-tilt."""
    f = np.fft.rfftfreq(n, 1.0 / rate)
    inside = (f >= low) & (f <= high)
    spectrum = np.zeros(f.size, dtype=complex)
    count = int(inside.sum())
    spectrum[inside] = rng.standard_normal(count) + 1j * rng.standard_normal(count)
    spectrum[inside] *= f[inside] ** (-0.5 * tilt)
    noise = np.fft.irfft(spectrum, n)
    return noise / max(float(noise.std()), 1e-300)

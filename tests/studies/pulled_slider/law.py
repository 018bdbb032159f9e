"""The slider, its nominal friction law, and the terms that the law may lack."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from tests.studies.pulled_slider.motion import slide

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["SLIDER_TERMS", "Slider", "SliderTerm"]

_GRAVITY = 9.81
_STEPS = 8
_PLACES = 4096


@dataclass(frozen=True)
class Slider:
    """Weight and friction of a slider.

    Parameters
    ----------
    weight : float
        [N].
    static, kinetic : float
        Friction coefficients.
    growth, waiting : float
        The static coefficient grows by `growth` times ``log(1 + t / waiting)`` in a stick of
        duration t [s].
    fall, fall_speed : float
        The kinetic coefficient falls by `fall` with ``1 - exp(-v / fall_speed)`` [m/s].
    viscous : float
        It grows by this a sliding speed [s/m].
    inertia : float
        Moving mass over weight / 9.81.
    scatter, spacing : float
        Standard deviation of both coefficients along the surface, and length over which they keep
        their value [m].
    """

    weight: float
    static: float
    kinetic: float
    growth: float = 0.0
    waiting: float = 0.01
    fall: float = 0.0
    fall_speed: float = 1e-3
    viscous: float = 0.0
    inertia: float = 1.0
    scatter: float = 0.0
    spacing: float = 1e-4

    def force(
        self, stiffness: float, pull: float, rate: float, samples: int, seed: int = 0
    ) -> NDArray[np.float64]:
        """Spring force over weight, shape (samples,).

        Parameters
        ----------
        stiffness : float
            Of the spring [N/m].
        pull : float
            Speed of its far end [m/s].
        rate : float
            Sampling rate [Hz].
        samples : int
            How many.
        seed : int
            Of the surface: one seed is one surface, whatever slides over it.

        Examples
        --------
        >>> force = Slider(0.3, 0.4, 0.3).force(168.0, 1e-4, 2000.0, 20000)
        >>> bool(0.39 < force.max() < 0.41), bool(0.19 < force.min() < 0.21)
        (True, True)
        """
        heights = np.random.default_rng(seed).standard_normal(_PLACES)
        mass = self.inertia * self.weight / _GRAVITY
        law = np.array(
            [
                self.static,
                self.kinetic,
                self.growth,
                self.waiting,
                self.fall,
                self.fall_speed,
                self.viscous,
                self.scatter,
            ]
        )
        result: NDArray[np.float64] = slide(
            samples,
            rate,
            _STEPS,
            pull,
            float(np.sqrt(stiffness / mass)),
            _GRAVITY / self.inertia,
            law,
            heights,
            self.spacing,
        )
        return result


@dataclass(frozen=True)
class SliderTerm:
    """A term of the friction law that the nominal one lacks.

    Parameters
    ----------
    name, meaning : str
        As in results, and in the words of a report.
    fields : tuple of str
        What it frees of `Slider`.
    starts, lowest, highest : tuple of float
        Where the search starts, and its bounds; searched by their logarithms.

    Examples
    --------
    >>> SLIDER_TERMS[0].put(Slider(0.3, 0.4, 0.3), (0.01, 0.1)).growth
    0.01
    """

    name: str
    meaning: str
    fields: tuple[str, ...]
    starts: tuple[float, ...]
    lowest: tuple[float, ...]
    highest: tuple[float, ...]

    def put(self, slider: Slider, values: tuple[float, ...]) -> Slider:
        """Return a slider that has the term."""
        return replace(slider, **dict(zip(self.fields, values, strict=True)))

    def joined(self, other: SliderTerm) -> SliderTerm:
        """Both terms at once."""
        return SliderTerm(
            f"{self.name} + {other.name}",
            f"{self.meaning}, and {other.meaning}",
            self.fields + other.fields,
            self.starts + other.starts,
            self.lowest + other.lowest,
            self.highest + other.highest,
        )


SLIDER_TERMS = (
    SliderTerm(
        "static_ageing",
        "the static friction grows with the logarithm of the time in stick",
        ("growth", "waiting"),
        (0.01, 0.02),
        (1e-4, 1e-4),
        (0.1, 1.0),
    ),
    SliderTerm(
        "velocity_weakening",
        "the kinetic friction falls with sliding speed",
        ("fall", "fall_speed"),
        (0.03, 3e-3),
        (1e-3, 1e-4),
        (0.3, 0.1),
    ),
    SliderTerm(
        "viscous_resistance",
        "the kinetic friction grows with sliding speed",
        ("viscous",),
        (1.0,),
        (0.01,),
        (100.0,),
    ),
    SliderTerm(
        "inertia",
        "the moving mass is not that of the weight",
        ("inertia",),
        (0.8,),
        (0.3,),
        (3.0,),
    ),
    SliderTerm(
        "surface_scatter",
        "friction differs from place to place",
        ("scatter", "spacing"),
        (0.02, 1e-4),
        (1e-3, 1e-5),
        (0.2, 2e-3),
    ),
)
"""Rivals of each other."""

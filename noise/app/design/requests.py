"""What is asked about a design: a chart of its noises, a change that ends one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from models.errors import ParameterError

if TYPE_CHECKING:
    from models.rig import Rig
    from sim.live_setting import Setting

__all__ = ["ChartRequest", "SuggestionRequest"]

_LEAST, _MOST = 0.05, 200.0
"""Speeds at which a noise is looked for [rad/s]."""


@dataclass(frozen=True)
class ChartRequest:
    """What a chart is of; speed and interference are its axes.

    Parameters
    ----------
    rig : Rig
    support_stiffness : float
        [Nm/rad]
    temperature : float
        [degree Celsius]
    """

    rig: Rig
    support_stiffness: float
    temperature: float

    @classmethod
    def of(cls, setting: Setting) -> ChartRequest:
        """Return what is asked of a setting."""
        return cls(setting.rig, setting.support_stiffness, setting.temperature)


@dataclass(frozen=True)
class SuggestionRequest:
    """What a change is to end the noise of: one condition.

    Parameters
    ----------
    chart : ChartRequest
    interference : float
        [m]
    speed : float
        [rad/s]
    """

    chart: ChartRequest
    interference: float
    speed: float

    @classmethod
    def of(cls, setting: Setting, said: object) -> SuggestionRequest:
        """Return what is asked of a setting, at the speed that a request may state with it.

        Raises
        ------
        ParameterError
            That is no speed.
        """
        stated = said.get("speed") if isinstance(said, dict) else None
        if stated is None:
            speed = float(np.abs(setting.shaft.speed(np.zeros(1)))[0])
        elif isinstance(stated, int | float) and abs(stated) <= _MOST:
            speed = abs(float(stated))
        else:
            raise ParameterError(f"speed {str(stated)[:20]}: must be a number up to {_MOST:g}")
        return cls(ChartRequest.of(setting), setting.interference, max(speed, _LEAST))

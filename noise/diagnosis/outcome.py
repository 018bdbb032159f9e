"""Outcome of a diagnosis as plain data: for the report, for `diagnosis.json`, for a notebook."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from models.show import short_repr

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from pandas import DataFrame

    from models.rig import Rig
    from noise.diagnosis.findings import (
        Agreement,
        EffectFinding,
        HypothesisFinding,
        Illustration,
        LabelsAndLevels,
        Location,
        Remainder,
        StageFinding,
    )
    from noise.diagnosis.improvement import Improvement


@short_repr
@dataclass(frozen=True, eq=False)
class Diagnosis:
    """The whole answer.

    Parameters
    ----------
    verdict : tuple of str
        Empty: no gap beyond repeatability; ``("parameters",)``; ``("unknown",)``; or one to three
        effects.
    equivalent : tuple of (str, str)
        Pairs of effects that these channels cannot separate.
    location : Location, optional
        None where there is no gap.
    stages : mapping of str to StageFinding
        By `sim.effects.effect.Stage`, in the order of the chain.
    effects : tuple of EffectFinding
        The most probable first; ``parameters`` and ``unknown`` are not among them.
    probabilities : mapping of str to float
        Of ``none``, ``parameters``, ``unknown`` and of each effect being at work [-].
    parameters : mapping of str to (float, float)
        90 % interval of each rig parameter, relative to the rig file.
    next_measurement : str
    held_out : tuple of str
        Recordings that no fit has seen.
    gap, floor, p_value : float
        Of the case as a whole, before anything was fitted [-].
    seconds : float
        That it took [s].
    notes : tuple of str
        What is missing and what that costs; channels in bad health.
    labels_and_levels : tuple of LabelsAndLevels
    illustrations : tuple of Illustration
    differences : tuple of Location
        Every stage, channel, band and phase with its p-value, corrected for the number of looks;
        the surest first.
    improvement : Improvement, optional
        What closes the gap; None where nothing does, and where it was not looked for.
    hypotheses : tuple of HypothesisFinding
        Sets of causes, the likeliest first.
    agreement : tuple of Agreement
        Of each recording with the rig file, before anything was fitted.
    remainder : Remainder, optional
        None where the fit leaves no more than repeats differ by, and where there was none.
    bench : tuple of str
        Why the recordings cannot be of the rig as it is described, one line each; nothing else was
        then looked for, and the verdict is ``("unknown",)``.
    faults : tuple of str
        Channels that are dead, and were left out, or clip, one line each.

    Examples
    --------
    >>> hum = Diagnosis(("mains_hum",), (), None, {}, (), {"mains_hum": 0.97}, {}, "", (),
    ...                 5.0, 1.0, 1e-6, 20.0)
    >>> hum.verdict, hum.probabilities["mains_hum"], hum.gap
    (('mains_hum',), 0.97, 5.0)
    """

    verdict: tuple[str, ...]
    equivalent: tuple[tuple[str, str], ...]
    location: Location | None
    stages: Mapping[str, StageFinding]
    effects: tuple[EffectFinding, ...]
    probabilities: Mapping[str, float]
    parameters: Mapping[str, tuple[float, float]]
    next_measurement: str
    held_out: tuple[str, ...]
    gap: float
    floor: float
    p_value: float
    seconds: float
    notes: tuple[str, ...] = ()
    labels_and_levels: tuple[LabelsAndLevels, ...] = ()
    illustrations: tuple[Illustration, ...] = ()
    differences: tuple[Location, ...] = ()
    improvement: Improvement | None = None
    hypotheses: tuple[HypothesisFinding, ...] = ()
    agreement: tuple[Agreement, ...] = ()
    remainder: Remainder | None = None
    bench: tuple[str, ...] = ()
    faults: tuple[str, ...] = ()

    @property
    def improved(self) -> Rig | None:
        """The rig with what closes the gap; None where nothing does."""
        return None if self.improvement is None else self.improvement.rig

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw how probable each cause is.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Where to draw; by default a new figure.

        Returns
        -------
        matplotlib.axes.Axes
        """
        from noise.diagnosis.text.diagnosis_display import draw_causes

        return draw_causes(self, ax)

    def to_pandas(self) -> DataFrame:
        """Return one row an effect as a data frame of pandas, as ``diagnosis.json`` names it.

        Returns
        -------
        pandas.DataFrame
            The most probable first; its parameters are a dictionary.

        Raises
        ------
        ParameterError
            pandas is not installed.
        """
        from models.show import data_frame
        from noise.diagnosis.outcome_json import as_json

        effects = as_json(self)["effects"]
        return data_frame([*effects[0]] if effects else ["name"], effects)

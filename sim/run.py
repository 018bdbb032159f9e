"""One run of the rig: from an operating condition to a recording, as the rig's computer has it."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from numbers import Real
from typing import TYPE_CHECKING

import numpy as np

from models.condition import Condition
from models.errors import ParameterError
from models.radiation.impulse_responses import radiate
from models.radiation.rig_response import response
from models.recording import Channel, Recording
from sim.acquisition import Acquisition, sample
from sim.chain import changed_chain
from sim.effects import EFFECTS
from sim.effects.effect import activated
from sim.friction import at_temperature
from sim.motion import Motion, simulate_motion
from sim.shaft import ConstantSpeed, ShaftMotion

if TYPE_CHECKING:
    from collections.abc import Mapping

    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from models.rig import Rig
    from sim.effects.effect import Effect

__all__ = ["DEFAULT_SETTLING", "Run", "simulate"]

DEFAULT_SETTLING = 0.5
"""How long a shaft at constant speed has turned before the recording starts [s]."""

_LEAST_SOUND_RATE = 90e3
"""Motion and sound are computed at a multiple of the sampling rate no lower than this [Hz]."""

_ABSOLUTE_ZERO = 273.15
"""Below 0 degree Celsius [K]."""

_LONGEST_RUN = 600.0
"""[s]; the whole run is held in memory."""


@dataclass(frozen=True, eq=False)
class Run:
    """What a simulated run gives.

    Parameters
    ----------
    recording : Recording
        What the sensors recorded.
    motion : Motion
        What moved, including what no sensor sees; at the rate of the computation.
    pressure : ndarray, shape (n,)
        Sound pressure at the microphone at ``motion.rate``, free of noise [Pa].
    pulse_pressure : ndarray, shape (n,)
        The part of `pressure` that slip pulses make through the plate [Pa].

    Examples
    --------
    >>> from models.rig_files.rig_file import load_material_rig
    >>> run = simulate(load_material_rig("PDMS"), 5.0, seconds=0.1)
    >>> run.motion.rate, run.pressure.shape
    (90000.0, (9000,))
    """

    recording: Recording
    motion: Motion
    pressure: NDArray[np.float64]
    pulse_pressure: NDArray[np.float64]

    def plot(
        self, ax: Axes | None = None, *, start: float | None = None, end: float | None = None
    ) -> Axes:
        """Draw the torques in contact and elastomer over time.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Where to draw; by default a new figure.
        start, end : float, optional
            What is shown [s]; by default the last tenth of a second.

        Returns
        -------
        matplotlib.axes.Axes

        Raises
        ------
        ParameterError
            There is nothing of the run between them.

        Examples
        --------
        >>> from matplotlib.figure import Figure
        >>> from models.rig_files.rig_file import load_material_rig
        >>> run = simulate(load_material_rig("PDMS"), 5.0, seconds=0.1)
        >>> run.plot(Figure().subplots()).get_title("left")
        'PDMS, 0.279 mm, 2214 Nm/rad, 5 rad/s'
        """
        from sim.run_display import draw_torques

        return draw_torques(self, ax, start=start, end=end)

    def _repr_html_(self) -> str:
        from sim.run_display import run_html

        return run_html(self)


def simulate(
    rig: Rig,
    shaft: ShaftMotion | float,
    *,
    interference: float = 0.279e-3,
    support_stiffness: float = 2214.0,
    temperature: float = 23.0,
    seconds: float = 1.0,
    acquisition: Acquisition | None = None,
    settling: float | None = None,
    library: Mapping[str, Effect] | None = None,
    rng: np.random.Generator | None = None,
) -> Run:
    """Simulate one run of the rig.

    Parameters
    ----------
    rig : Rig
    shaft : ShaftMotion or float
        How the shaft turns; a number is a constant speed [rad/s].
    interference : float
        [m]
    support_stiffness : float
        [Nm/rad]; ``math.inf`` for the clamp bolted to the baseplate.
    temperature : float
        Ambient [degree Celsius]; recorded, and taken by friction laws that have a temperature.
    seconds : float
        Length of the recording [s].
    acquisition : Acquisition, optional
        Sampling rate, noise and converter; by default 30 kHz.
    settling : float, optional
        How long the rig has run before the recording starts [s]; by default `DEFAULT_SETTLING`
        at constant speed, else none.
    library : mapping of str to Effect, optional
        Effects that the rig's can be found among; by default `sim.effects.EFFECTS`.
    rng : numpy.random.Generator, optional
        Of the sensors' noise and of effects that scatter; by default seeded with 0.

    Returns
    -------
    Run

    Raises
    ------
    ParameterError
        If a value cannot be used.

    Examples
    --------
    >>> from models.rig_files.rig_file import load_material_rig
    >>> run = simulate(load_material_rig("PDMS"), 5.0, seconds=0.1)
    >>> run.recording.channel_names, run.recording.samples.shape
    (('torque', 'acceleration', 'pressure', 'angle'), (4, 3000))
    """
    acquisition = acquisition or Acquisition()
    # Two streams, so that an effect that scatters leaves the sensors' noise as it is.
    noise_rng, effect_rng = (rng or np.random.default_rng(0)).spawn(2)
    shaft, settling = motion_and_settling(shaft, settling)
    _check(seconds, settling, acquisition.rate, interference, temperature)
    rig = replace(rig, friction=at_temperature(rig.friction, temperature))

    decimation = math.ceil(_LEAST_SOUND_RATE / acquisition.rate)
    rate = decimation * acquisition.rate
    n_kept = round(seconds * acquisition.rate) * decimation
    n_settling = round(settling * rate)
    effects = activated(rig.effects, library or EFFECTS)
    motion = simulate_motion(
        rig,
        shaft,
        interference=interference,
        support_stiffness=support_stiffness,
        seconds=(n_settling + n_kept) / rate,
        rate=rate,
        effects=effects,
        rng=effect_rng,
    )
    force = np.zeros_like(motion.torque)
    for active in effects:
        if active.effect.force is not None:
            force += active.effect.force(motion, active.form, active.values)
    paths = changed_chain(
        response(rig, interference, support_stiffness, rate), effects, effect_rng.spawn(1)[0]
    )
    acceleration, pressure = radiate(paths, motion.torque, force)
    _, pulse_pressure = radiate(paths, np.zeros_like(force), force)

    kept = slice(n_settling, None)
    signals = {
        "torque": motion.torque[kept],
        "acceleration": acceleration[kept],
        "pressure": pressure[kept],
        "angle": motion.shaft_angle[kept] - motion.shaft_angle[n_settling],
    }
    for active in effects:
        if active.effect.sensors is not None:
            signals = active.effect.sensors(signals, rate, active.form, active.values, effect_rng)
    sampled = sample(signals, decimation, acquisition, noise_rng)
    condition = Condition(
        speed=shaft.value if isinstance(shaft, ConstantSpeed) else None,
        interference=interference,
        support_stiffness=support_stiffness,
        material=rig.material,
        temperature=temperature,
    )
    recording = Recording(
        samples=np.stack(list(sampled.values())),
        rate=acquisition.rate,
        channels=_channels(rig),
        condition=condition,
    )
    return Run(
        recording=recording,
        motion=motion.since(n_settling),
        pressure=pressure[kept],
        pulse_pressure=pulse_pressure[kept],
    )


def motion_and_settling(
    shaft: ShaftMotion | float, settling: float | None
) -> tuple[ShaftMotion, float]:
    """Return the shaft's motion, a number being a constant speed, and how long it settles [s].

    Raises
    ------
    ParameterError
        If the shaft is neither a number nor a motion.

    Examples
    --------
    >>> motion_and_settling(5, None)
    (ConstantSpeed(value=5.0), 0.5)
    """
    if isinstance(shaft, Real):
        shaft = ConstantSpeed(float(shaft))
    if not isinstance(shaft, ShaftMotion):
        raise ParameterError(f"shaft = {shaft!r}: give a speed in rad/s, or a motion of sim.shaft")
    if settling is None:
        settling = DEFAULT_SETTLING if isinstance(shaft, ConstantSpeed) else 0.0
    return shaft, settling


def _channels(rig: Rig) -> tuple[Channel, ...]:
    return (
        Channel("torque"),
        Channel("acceleration"),
        Channel("pressure", position=rig.microphone.position),
        Channel("angle"),
    )


def _check(
    seconds: float, settling: float, rate: float, interference: float, temperature: float
) -> None:
    if not (0.0 < seconds <= _LONGEST_RUN and 0.0 <= settling <= _LONGEST_RUN):
        raise ParameterError(
            f"seconds = {seconds:g} must be above 0, settling = {settling:g} at least 0, both at "
            f"most {_LONGEST_RUN:g}"
        )
    if not 1e3 <= rate <= 400e3:
        raise ParameterError(f"rate = {rate:g} Hz must lie between 1000 and 400000")
    if round(seconds * rate) < 2:
        raise ParameterError(f"seconds = {seconds:g} holds no two samples at {rate:g} Hz")
    if not -_ABSOLUTE_ZERO <= temperature < 1e4:
        raise ParameterError(f"temperature = {temperature:g} degree Celsius is none")
    if not 0.0 < interference < 1e-2:
        raise ParameterError(
            f"interference = {1e3 * interference:g} mm must be above 0 and below 10"
        )

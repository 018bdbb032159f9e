"""Fit of stiffness, inertias and damping to one recording, independent of the law of friction.

Two things hold for any law in which a contact sticks. While it sticks, the surface turns with the
shaft: the torque rises by k_EFF times the speed (Figures 5.25 and 5.26), and what the clamp rings
with decays by its damping. While it slides, the contact's torque changes little: the elastomer
rings freely about it (5.3 to 5.7), by its stiffness, inertia and damping. So stick and slip are
told apart by a first guess, and the numbers are those with which the surface follows the shaft best
in stick and the contact's torque depends best on speed alone in sliding; twice over.

Contact and shaft are rebuilt from the torque of the cell by the equations of
`noise.diagnosis.evidence.reconstruction`; here a fit asks for them some hundred times, so the
spectrum of the torque is kept and little else is computed.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft, rfft, rfftfreq
from scipy.ndimage import binary_erosion, uniform_filter1d
from scipy.optimize import least_squares

from models.show import short_repr
from noise.base.arrays import Array
from noise.diagnosis.evidence.reconstruction import LEAD, TAIL, closed_loop
from sim.bushing import LumpedBushing

if TYPE_CHECKING:
    from noise.identification.measured import Measured


LIMIT = 8000.0
"""Corner of the low-pass filter [Hz], at most 0.3 of the rate; it ends a third above; assumed."""

_NOISE_ALONE = 0.85
"""Share of the Nyquist frequency above which the spectrum is noise of the cell alone; assumed."""

_SMOOTHED = 150.0
"""Bandwidth over which the power spectrum is smoothed [Hz]; assumed."""


@short_repr
@dataclass(frozen=True, eq=False)
class Contact:
    """Torque and sliding speed of the contact over time.

    Parameters
    ----------
    torque : ndarray, shape (n,)
        In the contact [Nm].
    sliding_speed : ndarray, shape (n,)
        [rad/s]
    """

    torque: Array
    sliding_speed: Array


@short_repr
@dataclass(frozen=True, eq=False)
class TorqueSpectrum:
    """Low-pass filtered torque of a recording in the frequency domain.

    Parameters
    ----------
    spectrum : ndarray of complex, shape (n_lines,)
        Of the torque without its mean, band-limited [Nm].
    s : ndarray of complex, shape (n_lines,)
        i omega [rad/s]
    n : int
        Samples of the transform.
    used : slice
        Samples of the transform that belong to the recording.
    mean : float
        Of the torque [Nm].
    torque : ndarray, shape (n_used,)
        Band-limited [Nm].
    shaft_speed : ndarray, shape (n_used,)
        [rad/s]
    rate : float
        [Hz]
    """

    spectrum: NDArray[np.complex128]
    s: NDArray[np.complex128]
    n: int
    used: slice
    mean: float
    torque: Array
    shaft_speed: Array
    rate: float

    def contact(self, bushing: LumpedBushing) -> Contact:
        """Return the contact that a bushing implies."""
        twist, clamp = self._angles(bushing)
        turning = (twist + clamp) * self.s
        acceleration = self._in_time(turning * self.s)
        return Contact(
            self.torque + bushing.elastomer_inertia * acceleration,
            self.shaft_speed - self._in_time(turning),
        )

    def states(self, bushing: LumpedBushing) -> Array:
        """Return the motion that a bushing implies.

        Returns
        -------
        ndarray, shape (4, n_used)
            theta1 [rad], theta1' [rad/s], theta2, theta2', as of the torque's mean at rest.
        """
        twist, clamp = self._angles(bushing)
        rest = self.mean / bushing.support_stiffness
        surface = twist + clamp
        return np.stack([
            self._in_time(surface) + rest + self.mean / bushing.elastomer_stiffness,
            self._in_time(surface * self.s),
            self._in_time(clamp) + rest,
            self._in_time(clamp * self.s),
        ])  # fmt: skip

    def _angles(
        self, bushing: LumpedBushing
    ) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
        """Return the spectra of the elastomer's twist and of the clamp's angle."""
        s = self.s
        twist = self.spectrum / (bushing.elastomer_stiffness + bushing.elastomer_damping * s)
        if bushing.clamp_is_fixed:
            return twist, np.zeros_like(twist)
        clamp = self.spectrum / (
            bushing.support_stiffness + bushing.support_damping * s + bushing.clamp_inertia * s * s
        )
        return twist, clamp

    def _in_time(self, spectrum: NDArray[np.complex128]) -> Array:
        return np.asarray(irfft(spectrum, self.n)[self.used])


def torque_spectrum(measured: Measured, seconds: float | None = None) -> TorqueSpectrum:
    """Return the low-pass filtered spectrum of a recording's torque.

    Parameters
    ----------
    measured : Measured
    seconds : float, optional
        Length of the part to use [s]; by default all.

    Returns
    -------
    TorqueSpectrum
        Shorter than the recording by `LEAD` and `TAIL`.
    """
    rate, n = measured.rate, measured.torque.size
    if seconds is not None:
        n = min(n, round(seconds * rate))
    torque = measured.torque[:n]
    mean = float(np.mean(torque))
    closed = closed_loop(torque, rate) - mean
    frequency = rfftfreq(closed.size, 1.0 / rate)
    low = min(LIMIT, 0.3 * rate)
    x = np.clip((frequency - low) / (low / 3.0), 0.0, 1.0)
    lines = rfft(closed)
    spectrum = lines * _above_noise(lines, frequency) * (0.5 + 0.5 * np.cos(np.pi * x))
    used = slice(round(LEAD * rate), n - round(TAIL * rate))
    return TorqueSpectrum(
        spectrum, 2j * np.pi * frequency, closed.size, used, mean,
        np.asarray(irfft(spectrum, closed.size)[used]) + mean, measured.shaft_speed[used], rate,
    )  # fmt: skip


def _above_noise(lines: NDArray[np.complex128], frequency: Array) -> Array:
    """Return the Wiener filter against white noise of the cell (Wiener 1949).

    Differentiated noise would look like sliding where the contact sticks.
    """
    power = np.abs(lines) ** 2
    noise = float(np.mean(power[frequency > _NOISE_ALONE * frequency[-1]]))
    width = max(3, round(_SMOOTHED / frequency[1]))
    smooth = uniform_filter1d(power, width, mode="nearest")
    return np.asarray(np.maximum(1.0 - noise / np.maximum(smooth, noise), 0.0))


_GUARD = 0.8e-4
"""Margin at both ends of stick and slip [s], which the low-pass filter smears; assumed."""

_STUCK, _SLIDING = 0.25, 1.0
"""Sliding speeds over the shaft's speed: a contact sticks below the first and slides above the
second; assumed."""

_LEAST = 60
"""Fewest samples of a phase that is used; assumed."""

_THINNED = 6000
"""Most samples of a phase that a fit uses."""

_STIFFNESSES = tuple(np.geomspace(0.3, 3.0, 15).tolist())
_INERTIAS = tuple(np.geomspace(0.4, 2.5, 15).tolist())
"""Grid of factors on the stiffness of the slope, and on unknown inertias."""

_DAMPINGS = (0.06, 0.09, 0.14)
"""Grid of dampings [Nm s/rad] (about those of Table 5.5)."""

_RISES = (4e-4, 1e-3, 2e-3, 4e-3, 8e-3)
"""Time steps over which the slope of the torque is taken [s]; assumed."""

_WELL_KNOWN = 0.1
"""Relative error of the inertias above which they are searched on a grid [-]; assumed."""

_EXCERPT = 0.3
"""Part of the recording for the grid search [s]."""

_ROUNDS = 3
_BEND = 2.5
"""Threshold of Huber's loss in standard deviations; assumed."""


@dataclass(frozen=True)
class Known:
    """Prior knowledge of a rig's inertias and of how its damping is shared.

    Parameters
    ----------
    elastomer_inertia, clamp_inertia : float
        [kg m2]
    inertia_error : float
        Relative standard deviation of both [-]; large if they are unknown.
    damping_share : float
        Share of the damping that acts in the elastomer [-].
    share_error : float
        Its relative standard deviation [-].
    """

    elastomer_inertia: float
    clamp_inertia: float
    inertia_error: float
    damping_share: float = 0.5
    share_error: float = 0.02


class Phases(NamedTuple):
    """Masks of stick and slip, boolean arrays of shape (n,); transitions are in neither."""

    stuck: NDArray[np.bool_]
    sliding: NDArray[np.bool_]


@short_repr
@dataclass(frozen=True, eq=False)
class BushingFit:
    """Bushing fitted to one recording.

    Parameters
    ----------
    bushing : LumpedBushing
    spectrum : TorqueSpectrum
    """

    bushing: LumpedBushing
    spectrum: TorqueSpectrum

    @property
    def damping(self) -> float:
        """Damping of elastomer and beams together [Nm s/rad]."""
        return self.bushing.elastomer_damping + self.bushing.support_damping

    @cached_property
    def contact(self) -> Contact:
        """Contact that this bushing implies."""
        return self.spectrum.contact(self.bushing)

    @cached_property
    def phases(self) -> Phases:
        """Masks of stick and slip."""
        return _phases(self.contact, self.spectrum)


def _phases(contact: Contact, spectrum: TorqueSpectrum) -> Phases:
    """Return the masks of stick and slip from the sliding speed."""
    guard = np.ones(2 * max(1, round(_GUARD * spectrum.rate)) + 1)
    v = contact.sliding_speed
    # apparent sliding speed of a sticking contact: noise of the cell
    noise = 1.4826 * float(np.median(np.abs(np.diff(v)))) / math.sqrt(2.0)
    stuck = np.abs(v) < _STUCK * spectrum.shaft_speed + 3.0 * noise
    sliding = v > _SLIDING * spectrum.shaft_speed + 3.0 * noise
    return Phases(binary_erosion(stuck, guard), binary_erosion(sliding, guard))


def fit_bushing(measured: Measured, known: Known) -> BushingFit:
    """Fit the bushing to one recording.

    Parameters
    ----------
    measured : Measured
    known : Known

    Returns
    -------
    BushingFit
    """
    spectrum = torque_spectrum(measured)
    support = measured.condition.support_stiffness
    values = _start(measured, known)
    for _ in range(_ROUNDS):
        values = _refined(spectrum, support, known, values)
    return BushingFit(_bushing(values, support, known), spectrum)


def _bushing(values: Array, support: float, known: Known) -> LumpedBushing:
    stiffness, damping, elastomer, clamp = np.exp(values).tolist()
    share = known.damping_share
    return LumpedBushing(
        elastomer, clamp, stiffness, support, share * damping, (1.0 - share) * damping
    )


def _static_stiffness(spectrum: TorqueSpectrum, support: float, step: int) -> float:
    """Return the elastomer's stiffness from the slope of the torque over `step` samples."""
    slope = (spectrum.torque[step:] - spectrum.torque[:-step]) * spectrum.rate / step
    slope = slope / spectrum.shaft_speed[step:]
    rising = slope[slope > 0.25 * np.quantile(slope, 0.9)]
    k_eff = float(np.median(rising)) if rising.size else 500.0
    flexible = 1.0 / k_eff - (0.0 if math.isinf(support) else 1.0 / support)
    return 1.0 / max(flexible, 0.2 / k_eff)


def _start(measured: Measured, known: Known) -> Array:
    """Return the best stiffness, damping and (if unknown) inertias on a coarse grid."""
    support = measured.condition.support_stiffness
    spectrum = torque_spectrum(measured, _EXCERPT)
    # over a short step ringing of the clamp hides the slope; a long step contains slips
    steps = {max(1, round(seconds * spectrum.rate)) for seconds in _RISES}
    slopes = [_static_stiffness(spectrum, support, step) for step in steps]
    low, high = _STIFFNESSES[0] * min(slopes), _STIFFNESSES[-1] * max(slopes)
    n = math.ceil(math.log(high / low) / math.log(_STIFFNESSES[1] / _STIFFNESSES[0])) + 1
    inertias = known.elastomer_inertia, known.clamp_inertia
    start = _likeliest(spectrum, support, known, [
        np.log([k, damping, *inertias])
        for k, damping in itertools.product(np.geomspace(low, high, n), _DAMPINGS)
    ])  # fmt: skip
    if known.inertia_error <= _WELL_KNOWN:
        return start
    clamps = (1.0,) if math.isinf(support) else _INERTIAS
    return _likeliest(spectrum, support, known, [
        start + np.log([stiffer, 1.0, elastomer, clamp])
        for stiffer, elastomer, clamp in itertools.product(_STIFFNESSES, (0.7, 1.0, 1.4), clamps)
    ])  # fmt: skip


def _likeliest(
    spectrum: TorqueSpectrum, support: float, known: Known, guesses: list[Array]
) -> Array:
    costs = [_implausibility(spectrum, _bushing(values, support, known)) for values in guesses]
    return guesses[int(np.argmin(costs))]


def _implausibility(spectrum: TorqueSpectrum, bushing: LumpedBushing) -> float:
    """Return how much of the time the contact slides, plus how far it slides backwards."""
    ratio = spectrum.contact(bushing).sliding_speed / spectrum.shaft_speed
    away = (ratio / _STUCK) ** 2
    return float(np.mean(away / (1.0 + away)) + np.mean(np.clip(-ratio, 0.0, 2.0)))


def _thin(mask: NDArray[np.bool_]) -> NDArray[np.int64]:
    inside = np.flatnonzero(mask)
    return inside[:: max(1, math.ceil(inside.size / _THINNED))]


def _refined(spectrum: TorqueSpectrum, support: float, known: Known, start: Array) -> Array:
    """Refine the values by least squares, with the phases that they imply."""
    phases = _phases(spectrum.contact(_bushing(start, support, known)), spectrum)
    stuck, sliding = _thin(phases.stuck), _thin(phases.sliding)
    prior = np.log([1.0, 1.0, known.elastomer_inertia, known.clamp_inertia])
    prior[:2] = start[0], math.log(0.09)
    width = np.array([0.5, 1.0, known.inertia_error, known.inertia_error])

    def parts(values: Array) -> tuple[Array, Array]:
        contact = spectrum.contact(_bushing(values, support, known))
        in_stick = contact.sliding_speed[stuck] if stuck.size > _LEAST else np.zeros(0)
        in_slip = np.zeros(0)
        if sliding.size > _LEAST:
            v, torque = contact.sliding_speed[sliding], contact.torque[sliding]
            x = np.log1p(np.maximum(v, 0.0))
            x = x - x.mean()
            spread = float(x @ x) + 1e-12
            in_slip = torque - torque.mean() - x * float(x @ torque) / spread
        return in_stick, in_slip

    def sigma(rest: Array, least: float) -> float:
        return max(1.4826 * float(np.median(np.abs(rest))), least) if rest.size else 1.0

    first, second = parts(start)
    scale_v = sigma(first, 0.01 * float(np.mean(spectrum.shaft_speed)))
    scale_t = sigma(second, 2e-3 * float(np.mean(np.abs(spectrum.torque))))
    # neighbouring samples are correlated: each millisecond counts as one observation
    count = 1e-3 * spectrum.rate

    def weight(rest: Array, mask: NDArray[np.bool_]) -> float:
        return math.sqrt(mask.sum() / count / rest.size) if rest.size else 0.0

    def residuals(values: Array) -> Array:
        in_stick, in_slip = parts(values)
        return np.concatenate([
            _bent(in_stick / scale_v) * weight(in_stick, phases.stuck),
            _bent(in_slip / scale_t) * weight(in_slip, phases.sliding),
            (values - prior) / width,
        ])  # fmt: skip

    fit = least_squares(residuals, start, method="lm", diff_step=1e-4, max_nfev=60)
    return np.asarray(np.clip(fit.x, start - 0.7, start + 0.7))


def _bent(x: Array) -> Array:
    """Return residuals whose squares are Huber's loss."""
    size = np.abs(x)
    large = np.sign(x) * np.sqrt(_BEND * np.maximum(2.0 * size - _BEND, 0.0))
    return np.asarray(np.where(size <= _BEND, x, large))


# --- torque levels of a fitted recording ----------------------------------------------------------

_FAST = 0.6
"""Share of the fastest sliding speed above which the contact slides fast; assumed."""

_SLOW = 0.6
"""Sliding speed over the shaft's speed below which the contact is slow; assumed."""

_LEAST_SAMPLES = 20


@dataclass(frozen=True)
class Levels:
    """Torque levels of one recording.

    Parameters
    ----------
    mean : float
        Of the torque [Nm].
    critical, kinetic : float
        Median of the highest torque of each cycle, and torque of the contact in fast sliding [Nm].
    slips : int
        Number of slips.
    """

    mean: float
    critical: float
    kinetic: float
    slips: int


def torque_levels(fit: BushingFit) -> Levels:
    """Return the torque levels of a fitted recording.

    Parameters
    ----------
    fit : BushingFit

    Returns
    -------
    Levels
        If nothing sticks, critical and kinetic torque are the mean torque of the contact.
    """
    torque, contact = fit.spectrum.torque, fit.contact
    v = contact.sliding_speed
    mean = float(np.mean(torque))
    fastest = float(np.quantile(v, 0.995))
    fast = v > max(_FAST * fastest, 1.1 * float(np.mean(fit.spectrum.shaft_speed)))
    begins = _slips(v, fit.spectrum.shaft_speed)
    if begins.size < 2 or fast.sum() < _LEAST_SAMPLES:
        return Levels(mean, mean, mean, 0)
    peaks = np.array([
        np.max(torque[a:b]) for a, b in itertools.pairwise(begins)
    ])  # fmt: skip
    sliding = float(np.mean(contact.torque[fast]))
    return Levels(mean, float(np.median(peaks)), sliding, int(begins.size))


def _slips(v: Array, shaft_speed: Array) -> NDArray[np.int64]:
    """Return the samples at which the contact begins to slide, having been slow before."""
    state = np.where(v > shaft_speed, 1, np.where(v < _SLOW * shaft_speed, -1, 0))
    clear = np.flatnonzero(state)
    return np.asarray(clear[1:][(state[clear[1:]] == 1) & (state[clear[:-1]] == -1)])

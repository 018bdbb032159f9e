"""A measured frequency response function: one output per unit of one input, line by line.

What a file holds is checked here once, whatever its format, so that all that follows may trust
it: lines rise, numbers are finite, units are those of the quantity asked for. Values are never
guessed, only spellings of the same unit are alike.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from models.errors import ParameterError

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

__all__ = [
    "Frf",
    "bands_below",
    "check_band",
    "check_frf",
    "check_units",
    "same_unit",
    "trusted_band",
]

FEWEST_LINES = 8
"""Fewer lines describe no resonance."""

LEAST_COHERENCE = 0.5
"""Below it less than half of the output's power comes from the input."""

_SMOOTHING = 1.06
"""Half width of the band over which the median of the coherence is taken: 1/6 octave in all."""


@dataclass(frozen=True, eq=False)
class Frf:
    """Frequency response function.

    Parameters
    ----------
    frequency : ndarray, shape (n,)
        [Hz], rising, evenly spaced or not.
    response : ndarray, shape (n,), complex
        Output per input, for signals that go as exp(+i omega t): a delay turns the phase back.
    coherence : ndarray, shape (n,), optional
        Between 0 and 1.
    input_unit, output_unit : str
        Such as ``"N m"`` and ``"Pa"``.
    name : str
        What messages call it, usually its file.

    Examples
    --------
    >>> Frf(np.array([1.0, 2.0]), np.array([1j, 2j]), None, "N", "m/s^2").spacing
    1.0
    """

    frequency: NDArray[np.float64]
    response: NDArray[np.complex128]
    coherence: NDArray[np.float64] | None
    input_unit: str
    output_unit: str
    name: str = "response"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Frf) and self._content == other._content

    def __hash__(self) -> int:
        return hash(self._content)  # alike in another process, where a copy of the rig works

    @property
    def _content(self) -> tuple[str | bytes, ...]:
        coherence = b"" if self.coherence is None else self.coherence.tobytes()
        arrays = (self.frequency.tobytes(), self.response.tobytes(), coherence)
        return *arrays, self.input_unit, self.output_unit, self.name

    @property
    def spacing(self) -> float:
        """Mean distance of the lines [Hz]."""
        return float((self.frequency[-1] - self.frequency[0]) / (self.frequency.size - 1))

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the magnitude over frequency; lines of a coherence below a half are pale.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Where to draw; by default a new figure.

        Returns
        -------
        matplotlib.axes.Axes

        Examples
        --------
        >>> from matplotlib.figure import Figure
        >>> frf = Frf(np.array([1.0, 2.0]), np.array([1j, 2j]), None, "N", "m/s^2")
        >>> frf.plot(Figure().subplots()).get_ylabel()
        'Magnitude [m/s^2 per N]'
        """
        from models.transfer_functions.transfer_function_display import draw_frf

        return draw_frf(self, ax)

    def _repr_html_(self) -> str:
        from models.transfer_functions.transfer_function_display import frf_html

        return frf_html(self)


def check_frf(frf: Frf) -> Frf:
    """Refuse a response that nothing can be done with.

    Raises
    ------
    ParameterError
        Shapes that do not fit, values that are not finite, lines that do not rise, a coherence
        outside 0 to 1, or nothing but zeros.

    Examples
    --------
    >>> check_frf(Frf(np.arange(9.0)[::-1], np.ones(9) + 0j, None, "N", "Pa", "hit.csv"))
    Traceback (most recent call last):
    models.errors.ParameterError: hit.csv: frequency_hz falls from 8 to 7 Hz at line 2; it must rise
    """
    f, n = frf.frequency, frf.frequency.size
    if frf.frequency.ndim != 1 or n < FEWEST_LINES:
        raise ParameterError(
            f"{frf.name}: frequency_hz has shape {f.shape}; it must be at least {FEWEST_LINES} "
            "frequencies in a row"
        )
    columns = {"frequency_hz": f, "response": frf.response}
    if frf.coherence is not None:
        columns["coherence"] = frf.coherence
    for key, values in columns.items():
        if values.shape != (n,):
            raise ParameterError(
                f"{frf.name}: {key} has shape {values.shape}, frequency_hz {f.shape}; "
                "they must be alike"
            )
        if not np.isfinite(values).all():
            first = int(np.argmin(np.isfinite(values)))
            raise ParameterError(
                f"{frf.name}: {key} is {values[first]} at line {first + 1}; it must be finite"
            )
    if f[0] < 0.0:
        raise ParameterError(
            f"{frf.name}: frequency_hz starts at {f[0]:g} Hz; it must be 0 or more"
        )
    steps = np.diff(f)
    if not (steps > 0.0).all():
        first = int(np.argmin(steps > 0.0))
        verb = "stays at" if steps[first] == 0 else f"falls from {f[first]:g} to"
        raise ParameterError(
            f"{frf.name}: frequency_hz {verb} {f[first + 1]:g} Hz at line {first + 2}; it must rise"
        )
    coherence = frf.coherence
    if coherence is not None and not (coherence.min() >= 0.0 and coherence.max() <= 1 + 1e-9):
        raise ParameterError(
            f"{frf.name}: coherence goes from {coherence.min():g} to {coherence.max():g}; "
            "it must lie between 0 and 1"
        )
    if not frf.response.any():
        raise ParameterError(f"{frf.name}: response is zero throughout")
    return frf


def check_units(frf: Frf, input_unit: str, output_unit: str) -> None:
    """Refuse a response of other quantities than those asked for.

    Raises
    ------
    ParameterError
        A unit is another one.

    Examples
    --------
    >>> check_units(Frf(np.arange(9.0), np.ones(9) + 0j, None, "Nm", "m/s²"), "N m", "m/s^2")
    """
    for key, found, wanted in (
        ("input_unit", frf.input_unit, input_unit),
        ("output_unit", frf.output_unit, output_unit),
    ):
        if not same_unit(found, wanted):
            raise ParameterError(f"{frf.name}: {key} is {found!r}; it must be {wanted!r}")


def same_unit(one: str, other: str) -> bool:
    """Whether two texts spell the same unit.

    Examples
    --------
    >>> same_unit("N·m", "N m"), same_unit("m/s**2", "m/s²"), same_unit("mN", "N m")
    (True, True, False)
    """
    return _spelling(one) == _spelling(other)


def trusted_band(frf: Frf, least: float = LEAST_COHERENCE) -> tuple[float, float]:
    """Lowest and highest frequency between which the response can be used [Hz].

    Without coherence these are its ends, but for a line at 0 Hz, where sensors measure nothing.
    With it, a line counts where the median coherence within 1/6 octave is at least `least`;
    single lines below it, such as at antiresonances, do no harm.

    Examples
    --------
    >>> f = np.arange(0.0, 101.0)
    >>> frf = Frf(f, np.ones(101) + 0j, np.where(f < 20, 0.1, 0.99), "N m", "Pa")
    >>> trusted_band(frf)
    (20.0, 100.0)
    """
    f = frf.frequency
    usable = f > 0.0
    if frf.coherence is not None:
        low = np.searchsorted(f, f / _SMOOTHING)
        high = np.searchsorted(f, f * _SMOOTHING, side="right")
        medians = [np.median(frf.coherence[a:b]) for a, b in zip(low, high, strict=True)]
        usable &= np.array(medians) >= least
    if not usable.any():
        return 0.0, 0.0
    lines = f[usable]
    return float(lines[0]), float(lines[-1])


def bands_below(frf: Frf, least: float) -> list[tuple[float, float]]:
    """Bands whose lines have a coherence below `least`, from first to last line [Hz].

    Lines nearer to each other than 6 % are told as one band. The line at 0 Hz does not count.

    Examples
    --------
    >>> f = np.arange(0.0, 101.0)
    >>> frf = Frf(f, np.ones(101) + 0j, np.where(f < 20, 0.1, 0.99), "N m", "Pa")
    >>> bands_below(frf, 0.8)
    [(1.0, 19.0)]
    """
    if frf.coherence is None:
        return []
    lines = frf.frequency[(frf.coherence < least) & (frf.frequency > 0.0)]
    gaps = np.flatnonzero(
        (lines[1:] > _SMOOTHING * lines[:-1]) & (np.diff(lines) > 1.5 * frf.spacing)
    )
    parts = np.split(lines, gaps + 1) if lines.size else []
    return [(float(part[0]), float(part[-1])) for part in parts]


def check_band(frf: Frf, low: float, high: float) -> None:
    """Refuse a response that does not span a band with usable lines.

    Raises
    ------
    ParameterError
        It starts above `low` or stops below `high` [Hz].

    Examples
    --------
    >>> check_band(Frf(np.arange(9.0), np.ones(9) + 0j, None, "N", "Pa", "hit.csv"), 1.0, 5e3)
    Traceback (most recent call last):
    models.errors.ParameterError: hit.csv: stops at 8 Hz; it must reach from 1 to 5000 Hz
    """
    first, last = trusted_band(frf)
    cause = ""
    if first > frf.frequency[frf.frequency > 0.0][0] or last < frf.frequency[-1]:
        cause = f" with a coherence of {LEAST_COHERENCE:g} or more"
    wanted = f"it must reach from {low:g} to {high:g} Hz{cause}"
    if last < high:
        raise ParameterError(f"{frf.name}: stops at {last:g} Hz; {wanted}")
    if first > low:
        raise ParameterError(f"{frf.name}: starts at {first:g} Hz; {wanted}")


def _spelling(unit: str) -> str:
    plain = unit.replace("²", "2").replace("**", "")
    return plain.translate({ord(sign): None for sign in " ^·⋅*.()"})

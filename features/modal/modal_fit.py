"""Modal fit of a measured response function: poles, damping and residues.

The least-squares complex frequency method fits a rational function in z = exp(-i omega T) to the
response. It is linear, needs no starting values and handles close modes. With rising order
physical poles are stable while those that fit noise move, so modes are selected automatically from
the stabilization diagram. Coefficients are complex and the band is mapped to half the unit circle,
which keeps the equations well conditioned for any bandwidth. A band is divided into overlapping
bands of few modes each, narrow ones first, then wide ones for broad modes.

Residues follow from all poles by linear least squares, and poles that contribute almost nothing are
dropped. A few Gauss-Newton steps then fit poles and residues together, since the
linear fit weights lines by the denominator, which underestimates damping in noise.

P. Guillaume, P. Verboven, S. Vanlanduit, H. Van der Auweraer, B. Peeters, A poly-reference
implementation of the least-squares complex frequency-domain estimator, Proc. IMAC 21 (2003).
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from threadpoolctl import threadpool_limits

from models.errors import ParameterError
from models.show import short_repr

ORDERS = tuple(range(4, 25, 2))
"""Orders of the denominators in each band."""

LINES = (250, 1000)
"""Lines of a narrow and of a wide band."""

OVERLAP = 0.3
"""Overlap of neighbouring bands."""

SAME_FREQUENCY, SAME_DAMPING = 1e-3, 0.3
"""Largest relative change of a stable pole between orders."""

STABLE = 4
"""Fewest orders in which a pole is stable."""

LARGEST_DAMPING = 0.2
"""Largest damping ratio of a pole."""

_TINY = 1e-12  # of the largest response, which keeps weights finite

FEWEST_LINES = 32

MOST_STEPS = 12
"""Most steps of the joint fit of poles and residues."""

SWEEPS = 3
"""Number of passes over all poles."""

GROUP, MARGIN = 12, 60.0
"""Poles fitted together, and margin of lines on either side in widths of the widest pole."""

EDGE = 8.0
"""Lines at the band's ends without poles, which would fit modes beyond the band."""

NEGLIGIBLE = 0.02
"""Least peak of a mode over the response around it; others are dropped."""

_ENOUGH = 1e-3  # relative gain of a step that is worth no further one


class Pole(NamedTuple):
    """Pole of a response function.

    Parameters
    ----------
    frequency : float
        Undamped natural frequency [Hz].
    damping_ratio : float
        Fraction of critical damping [-].
    orders : int
        Number of orders in which the pole is stable.
    """

    frequency: float
    damping_ratio: float
    orders: int


class _Measured(NamedTuple):
    """Response at frequencies [Hz], with the weight of each line."""

    f: NDArray[np.float64]
    h: NDArray[np.complex128]
    weight: NDArray[np.float64]

    def at(self, lines: slice | NDArray[np.bool_]) -> _Measured:
        return _Measured(self.f[lines], self.h[lines], self.weight[lines])


@short_repr
@dataclass(frozen=True, eq=False)
class Modes:
    """Modes of a response function of a structure.

    H(omega) = sum_r [R_r / (i omega - s_r) + conj(R_r) / (i omega - conj(s_r))] + residuals,
    with the poles s_r = 2 pi f_r (-zeta_r + i sqrt(1 - zeta_r^2)).

    Parameters
    ----------
    frequency : ndarray, shape (n_modes,)
        Undamped natural frequencies [Hz], rising.
    damping_ratio : ndarray, shape (n_modes,)
        Fractions of critical damping.
    residues : ndarray, shape (n_modes,), complex
        R_r [unit of the response times rad/s].
    residuals : ndarray, shape (4,)
        Real factors of 1/(i omega)^2, 1, i omega and (i omega)^2, relative to the highest omega:
        the contribution of modes outside the band.
    orders : ndarray, shape (n_modes,)
        Number of orders in which each pole is stable [-].
    highest : float
        Upper end of the band [Hz].

    Examples
    --------
    >>> one = np.ones(1)
    >>> mode = Modes(100 * one, 0.02 * one, 1j * one, np.zeros(4), one.astype(int), 200.0)
    >>> mode.poles.round(1)
    array([-12.6+628.2j])
    """

    frequency: NDArray[np.float64]
    damping_ratio: NDArray[np.float64]
    residues: NDArray[np.complex128]
    residuals: NDArray[np.float64]
    orders: NDArray[np.intp]
    highest: float

    @property
    def poles(self) -> NDArray[np.complex128]:
        """Poles s_r [rad/s], shape (n_modes,)."""
        return _poles(self.frequency, self.damping_ratio)

    def response(self, frequency: ArrayLike) -> NDArray[np.complex128]:
        """Return the response function at frequencies.

        Parameters
        ----------
        frequency : array_like, shape (n,)
            [Hz]

        Returns
        -------
        ndarray, shape (n,), complex
            In the unit of the response.
        """
        basis = _modal_basis(self.poles, np.asarray(frequency, dtype=np.float64), self.highest)
        coefficients = np.concatenate([self.residues.real, self.residues.imag, self.residuals])
        return np.asarray(coefficients @ basis)

    def only(self, some: slice | NDArray[np.bool_]) -> Modes:
        """Return some of the modes."""
        return replace(
            self,
            frequency=self.frequency[some],
            damping_ratio=self.damping_ratio[some],
            residues=self.residues[some],
            orders=self.orders[some],
        )


def _modes_of_poles(poles: list[Pole], measured: _Measured) -> Modes:
    """Return the modes of poles, with residues and residuals by linear least squares."""
    frequency, ratio, orders = np.array(poles).reshape(-1, 3).T
    highest, n = float(measured.f[-1]), frequency.size
    basis = _modal_basis(_poles(frequency, ratio), measured.f, highest)
    factors = _least_squares(basis * measured.weight, measured.h * measured.weight)
    residues = factors[:n] + 1j * factors[n : 2 * n]
    return Modes(frequency, ratio, residues, factors[2 * n :], orders.astype(np.intp), highest)


def _modal_basis(
    poles: NDArray[np.complex128], f: NDArray[np.float64], highest: float
) -> NDArray[np.complex128]:
    """Return the responses of unit residues, real and imaginary, and of the four unit residuals."""
    s = 2j * np.pi * f
    here = 1 / (s - poles[:, None])
    there = 1 / (s - poles.conj()[:, None])
    x = s / (2 * np.pi * highest)
    return np.vstack([here + there, 1j * (here - there), x**-2, np.ones_like(x), x, x**2])


def _least_squares(
    basis: NDArray[np.complex128], target: NDArray[np.complex128]
) -> NDArray[np.float64]:
    """Return real factors of the rows of `basis` that sum to `target`, by normal equations."""
    parts = _real_and_imaginary(basis)
    scale = np.sqrt(np.maximum(np.sum(parts**2, axis=1), np.finfo(float).tiny))
    parts /= scale[:, None]
    right = parts @ _real_and_imaginary(target).T
    factors = np.linalg.lstsq(parts @ parts.T, right, rcond=1e-13)[0]
    return np.asarray(factors.T / scale)


def _real_and_imaginary(values: NDArray[np.complex128]) -> NDArray[np.float64]:
    """Return real and imaginary parts concatenated along the last axis."""
    return np.concatenate([values.real, values.imag], axis=-1)


def _poles(
    frequency: NDArray[np.float64], damping_ratio: NDArray[np.float64]
) -> NDArray[np.complex128]:
    return np.asarray(2 * np.pi * frequency * (-damping_ratio + 1j * np.sqrt(1 - damping_ratio**2)))


def _stable_poles(measured: _Measured) -> list[Pole]:
    """Return the poles of a response function that are stable over several orders."""
    poles: list[Pole] = []
    for size in LINES:
        new: list[Pole] = []
        for lines, least, most in _bands(measured.f, size):
            poles_by_order = _lscf(measured.at(lines))
            new += [pole for pole in _stable(poles_by_order) if least <= pole.frequency < most]
        poles = _merged(poles, new)
        if measured.f.size <= size:
            break
    return sorted(poles)


def _line_weights(h: NDArray[np.complex128], weight: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the weights of the lines of a fit, which decrease with the root of the response."""
    level = np.abs(h)
    return np.asarray(weight / np.sqrt(np.maximum(level, _TINY * level.max())))


def _bands(f: NDArray[np.float64], size: int) -> list[tuple[slice, float, float]]:
    """Return the lines of each band, and the limits of its poles."""
    if f.size <= size:
        return [(slice(0, f.size), float(f[0]), float(f[-1]) + 1e-9)]
    n = int(np.ceil((f.size / size - OVERLAP) / (1 - OVERLAP)))
    starts = np.rint(np.linspace(0, f.size - size, n)).astype(int)
    middles = [f[(a + size + b) // 2] for a, b in itertools.pairwise(starts)]
    limits = [f[0], *middles, f[-1] + 1e-9]
    return [
        (slice(start, start + size), float(limits[i]), float(limits[i + 1]))
        for i, start in enumerate(starts)
    ]


def _lscf(measured: _Measured) -> list[list[tuple[float, float]]]:
    """Return frequencies and damping ratios of the poles of each order."""
    f, h, weight = measured
    duration = 0.5 / (f[-1] - f[0])
    largest = min(ORDERS[-1], f.size // 2)
    z = np.exp(-2j * np.pi * np.outer(f - f[0], duration * np.arange(largest + 1)))
    x = _line_weights(h, weight)[:, None] * z
    y = -h[:, None] * x
    xx, xy, yy = x.conj().T @ x, x.conj().T @ y, y.conj().T @ y
    result = []
    for order in ORDERS:
        if order > largest:
            break
        n = order + 1
        numerator = np.linalg.lstsq(xx[:n, :n], xy[:n, :n], rcond=None)[0]
        reduced = yy[:n, :n] - xy[:n, :n].conj().T @ numerator
        # With the highest coefficient equal to one, poles that fit noise become unstable.
        a = np.ones(n, dtype=np.complex128)
        a[:-1] = np.linalg.lstsq(reduced[:-1, :-1], -reduced[:-1, -1], rcond=None)[0]
        roots = np.roots(a[::-1])
        s = -np.log(roots[roots != 0]) / duration + 2j * np.pi * f[0]
        natural = np.abs(s)
        ratio = -s.real / natural
        keep = (ratio > 0.0) & (ratio < LARGEST_DAMPING)
        keep &= (s.imag > 2 * np.pi * f[0]) & (s.imag < 2 * np.pi * f[-1])
        result.append(
            [*zip((natural[keep] / (2 * np.pi)).tolist(), ratio[keep].tolist(), strict=True)]
        )
    return result


def _stable(by_order: list[list[tuple[float, float]]]) -> list[Pole]:
    """Return the poles that are stable over several orders."""
    chains: list[list[tuple[float, float]]] = []
    alive: list[list[tuple[float, float]]] = []
    for poles in by_order:
        extended: list[list[tuple[float, float]]] = []
        taken: set[int] = set()
        for frequency, ratio in poles:
            near = [
                (abs(chain[-1][0] / frequency - 1.0), i)
                for i, chain in enumerate(alive)
                if i not in taken
                and abs(chain[-1][0] / frequency - 1.0) < SAME_FREQUENCY
                and abs(chain[-1][1] / ratio - 1.0) < SAME_DAMPING
            ]
            if near:
                i = min(near)[1]
                taken.add(i)
                alive[i].append((frequency, ratio))
                extended.append(alive[i])
            else:
                chains.append([(frequency, ratio)])
                extended.append(chains[-1])
        alive = extended
    stable = []
    for chain in chains:
        if len(chain) >= STABLE:
            frequency, ratio = np.median(chain[len(chain) // 2 :], axis=0).tolist()
            stable.append(Pole(frequency, ratio, len(chain)))
    return stable


def _merged(poles: list[Pole], new: list[Pole]) -> list[Pole]:
    """Return poles with the new ones that are neither among them nor part of a broken chain."""
    merged = list(poles)
    for pole in sorted(new, key=lambda pole: -pole.orders):
        f, width = pole.frequency, pole.damping_ratio * pole.frequency
        apart = max(width, SAME_FREQUENCY * f)
        if all(abs(f - other.frequency) > apart for other in poles) and all(
            abs(f - other.frequency) > 0.5 * width for other in merged
        ):
            merged.append(pole)
    return merged


def fit_modes(
    frequency: NDArray[np.float64],
    response: NDArray[np.complex128],
    *,
    low: float,
    high: float,
    coherence: NDArray[np.float64] | None = None,
) -> Modes:
    """Fit modes to a response function between two frequencies.

    Parameters
    ----------
    frequency : ndarray, shape (n,)
        [Hz], rising.
    response : ndarray, shape (n,), complex
        In any unit.
    low, high : float
        Limits of the band [Hz].
    coherence : ndarray, shape (n,), optional
        Weights the lines [-].

    Returns
    -------
    Modes
        Empty if no pole is stable.

    Raises
    ------
    ParameterError
        The band has too few lines.

    Examples
    --------
    >>> f = np.arange(1.0, 501.0)
    >>> H = sum(1 / (n**2 - f**2 + 2j * zeta * n * f) for n, zeta in ((100, 0.02), (300, 0.01)))
    >>> modes = fit_modes(f, H, low=20.0, high=450.0)
    >>> modes.frequency.round(2), modes.damping_ratio.round(4)
    (array([100., 300.]), array([0.02, 0.01]))
    """
    inside = (frequency >= low) & (frequency <= high) & (frequency > 0.0)
    weight = np.ones(frequency.size) if coherence is None else coherence
    f, h, weight = frequency[inside], response[inside], weight[inside]
    if f.size < FEWEST_LINES:
        raise ParameterError(
            f"{f.size} lines lie between {low:g} and {high:g} Hz; modes need {FEWEST_LINES} or more"
        )
    # Many small products: several threads take twenty times as long as one.
    with threadpool_limits(limits=1, user_api="blas"):
        edge = EDGE * float(f[1] - f[0])
        first, last = float(f[0]) + edge, float(f[-1]) - edge
        measured = _Measured(f, h, _line_weights(h, weight))
        poles = _stable_poles(_Measured(f, h, weight))
        for sweep in range(SWEEPS + 1):
            within = [pole for pole in poles if first < pole.frequency < last]
            modes = _pruned(_merged([], within), measured)  # of doubles the most stable one
            if sweep < SWEEPS:
                poles = _refined(modes, measured)
        return modes


def _pruned(poles: list[Pole], measured: _Measured) -> Modes:
    """Return the modes of the poles that are visible in the response."""
    poles = sorted(poles)
    while True:
        modes = _modes_of_poles(poles, measured)
        share = _share(modes, measured)
        if share.size == 0 or share.min() >= NEGLIGIBLE:
            return modes
        # Drop only the weakest; one just below the limit may be visible without them.
        limit = max(share.min(), 0.25 * NEGLIGIBLE)
        poles = [pole for pole, its in zip(poles, share, strict=True) if its > limit]


def _refined(modes: Modes, measured: _Measured) -> list[Pole]:
    """Return the poles after Gauss-Newton steps, a few neighbours at a time."""
    f, poles = measured.f, _poles_of(modes)
    refined: list[Pole] = []
    for group in _groups(modes.frequency):
        some = modes.only(group)
        first, last = some.frequency[[0, -1]]
        width = MARGIN * float(np.max(some.frequency * some.damping_ratio))
        lines = (f >= first - width) & (f <= last + width)
        if np.count_nonzero(lines) < FEWEST_LINES:
            lines = np.abs(f - 0.5 * (first + last)) <= 0.5 * FEWEST_LINES * (f[1] - f[0])
        near = measured.at(lines)
        alone = replace(some, residuals=np.zeros_like(modes.residuals)).response(near.f)
        target = near.h - modes.response(near.f) + alone
        refined += _moved(poles[group], near._replace(h=target))
    return refined


def _groups(frequency: NDArray[np.float64]) -> list[slice]:
    """Return groups of neighbours that are fitted together, split at the widest gaps."""
    limits = [0]
    while frequency.size - limits[-1] > GROUP:
        start = limits[-1]
        gaps = np.diff(np.log(frequency[start + GROUP // 2 - 1 : start + GROUP + 1]))
        limits.append(start + GROUP // 2 + int(np.argmax(gaps)))
    limits.append(frequency.size)
    return [slice(a, b) for a, b in itertools.pairwise(limits) if b > a]


def _moved(poles: list[Pole], measured: _Measured) -> list[Pole]:
    """Return the poles after as many steps as reduce the misfit."""
    modes = _modes_of_poles(poles, measured)
    error = _misfit(modes, measured)
    for _ in range(MOST_STEPS):
        new = _modes_of_poles(_stepped(modes, measured), measured)
        new_error = _misfit(new, measured)
        if new_error >= error:
            break
        modes, gain, error = new, error - new_error, new_error
        if gain < _ENOUGH * error:
            break
    return _poles_of(modes)


def _poles_of(modes: Modes) -> list[Pole]:
    values = (modes.frequency, modes.damping_ratio, modes.orders)
    return [Pole(*of) for of in zip(*(each.tolist() for each in values), strict=True)]


def _stepped(modes: Modes, measured: _Measured) -> list[Pole]:
    """Return the poles after one step, each moved by at most half its width."""
    n, s = modes.frequency.size, 2j * np.pi * measured.f
    poles = modes.poles
    here = 1 / (s - poles[:, None]) ** 2
    there = 1 / (s - poles.conj()[:, None]) ** 2
    basis = _modal_basis(poles, measured.f, modes.highest)
    weight = measured.weight
    turned = modes.residues[:, None]
    a, b = turned * here, turned.conj() * there
    left = measured.h - modes.response(measured.f)
    moves = np.vstack([a + b, 1j * (a - b), left]) * weight
    # Project out the part that residues can fit alone.
    other = basis * weight
    solved = _least_squares(other, moves)
    rest = _real_and_imaginary(moves) - solved @ _real_and_imaginary(other)
    gram = rest @ rest.T
    matrix, right = gram[:-1, :-1], gram[:-1, -1]
    norm = np.sqrt(np.maximum(np.diag(matrix), np.finfo(float).tiny))
    step = np.linalg.lstsq(matrix / np.outer(norm, norm), right / norm, rcond=1e-10)[0] / norm
    move = step[:n] + 1j * step[n:]
    width = -poles.real
    move *= np.minimum(1.0, 0.5 * width / np.maximum(np.abs(move), np.finfo(float).tiny))
    moved = poles + move
    natural = np.abs(moved)
    ratio = np.clip(-moved.real / natural, 1e-6, LARGEST_DAMPING)
    return _poles_of(replace(modes, frequency=natural / (2 * np.pi), damping_ratio=ratio))


def _misfit(modes: Modes, measured: _Measured) -> float:
    off = np.abs(measured.h - modes.response(measured.f))
    return float(np.sum((measured.weight * off) ** 2))


def _share(modes: Modes, measured: _Measured) -> NDArray[np.float64]:
    """Return the peak of each mode relative to the response within its width."""
    f, h, _ = measured
    half_widths = modes.damping_ratio * modes.frequency
    peaks = np.abs(modes.residues) / (2 * np.pi * half_widths)
    around = [
        np.abs(h[np.abs(f - frequency) <= max(half_width, f[1] - f[0])]).max()
        for frequency, half_width in zip(modes.frequency, half_widths, strict=True)
    ]
    return np.asarray(peaks / np.array(around))

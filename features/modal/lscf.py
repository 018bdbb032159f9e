"""Poles that response functions share, by linear least squares, those that last through orders.

The least-squares complex frequency method fits a quotient of polynomials in z = exp(-i omega T)
to all responses at once. It is linear, needs no starting values and does well with close modes;
and of the poles of ever higher orders physical ones stay where they are while those that fit
noise wander, so that modes can be told without a person picking them from a chart. Coefficients
are complex and the band is laid over half the unit circle, which keeps the equations well
conditioned however narrow the band. A band is cut into overlapping ones of few modes each, narrow
ones first and wide ones for what is too broad for those.

P. Guillaume, P. Verboven, S. Vanlanduit, H. Van der Auweraer, B. Peeters, A poly-reference
implementation of the least-squares complex frequency-domain estimator, Proc. IMAC 21 (2003).
"""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

ORDERS = tuple(range(4, 25, 2))
"""Orders of the denominators tried in each band."""

LINES = (250, 1000)
"""Lines of a band, narrow and wide."""

OVERLAP = 0.3
"""Share of a band that its neighbour covers, too."""

SAME_FREQUENCY, SAME_DAMPING = 1e-3, 0.3
"""Relative change from one order to the next within which a pole is the same."""

LASTING = 4
"""Orders that a pole must stay through."""

LARGEST_DAMPING = 0.2

_TINY = 1e-12  # of the largest response, which keeps weights finite


class Pole(NamedTuple):
    """A pole of response functions.

    Parameters
    ----------
    frequency : float
        Undamped natural frequency [Hz].
    damping_ratio : float
        Fraction of critical damping [-].
    orders : int
        Through how many orders it stayed.
    """

    frequency: float
    damping_ratio: float
    orders: int


def lasting_poles(
    f: NDArray[np.float64], h: NDArray[np.complex128], weight: NDArray[np.float64]
) -> list[Pole]:
    """Poles of response functions that stay through several orders.

    Parameters
    ----------
    f : ndarray, shape (n,)
        [Hz], rising, above 0.
    h : ndarray, shape (n_responses, n), complex
        In any [unit].
    weight : ndarray, shape (n_responses, n)
        Trust in each line, from 0 to 1 [-].

    Returns
    -------
    list of Pole
        By rising frequency.

    Examples
    --------
    >>> f = np.arange(1.0, 301.0)
    >>> H = 1 / (100.0**2 - f**2 + 2j * 0.02 * 100.0 * f)
    >>> [(round(pole.frequency, 2), round(pole.damping_ratio, 4))
    ...  for pole in lasting_poles(f, H[None], np.ones((1, 300)))]
    [(100.0, 0.02)]
    """
    found: list[Pole] = []
    for size in LINES:
        new: list[Pole] = []
        for lines, least, most in _bands(f, size):
            poles_by_order = _lscf(f[lines], h[:, lines], weight[:, lines])
            new += [pole for pole in _lasting(poles_by_order) if least <= pole.frequency < most]
        found = _merged(found, new)
        if f.size <= size:
            break
    return sorted(found)


def without_doubles(poles: list[Pole]) -> list[Pole]:
    """Of poles within half a mode's width of each other the one that stayed longest.

    Parameters
    ----------
    poles : list of Pole

    Returns
    -------
    list of Pole
        By rising frequency.

    Examples
    --------
    >>> pair = [Pole(100.0, 0.01, 4), Pole(100.3, 0.01, 9), Pole(101.0, 0.01, 5)]
    >>> [pole.frequency for pole in without_doubles(pair)]
    [100.3, 101.0]
    """
    return sorted(_merged([], poles))


def line_weights(h: NDArray[np.complex128], weight: NDArray[np.float64]) -> NDArray[np.float64]:
    """Weights of the lines of a fit: responses are neither weighted alike nor by their logarithm.

    Parameters
    ----------
    h : ndarray, shape (..., n), complex
        Response functions, in any unit.
    weight : ndarray, shape (..., n)
        Trust in each line, from 0 to 1 [-].

    Returns
    -------
    ndarray, shape (..., n)
        [1/unit^0.5]

    Examples
    --------
    >>> line_weights(np.array([4.0 + 0j, 1.0]), np.ones(2)).round(3)
    array([0.5, 1. ])
    """
    level = np.abs(h)
    largest = level.max(axis=-1, keepdims=True)
    return np.asarray(weight / np.sqrt(np.maximum(level, _TINY * largest)))


def _bands(f: NDArray[np.float64], size: int) -> list[tuple[slice, float, float]]:
    """Lines of each band, and the limits between which its poles are taken."""
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


def _lscf(
    f: NDArray[np.float64], h: NDArray[np.complex128], weight: NDArray[np.float64]
) -> list[tuple[NDArray[np.float64], NDArray[np.float64]]]:
    """Frequencies and damping ratios of the poles of each order."""
    duration = 0.5 / (f[-1] - f[0])
    largest = min(ORDERS[-1], f.size // 2)
    z = np.exp(-2j * np.pi * np.outer(f - f[0], duration * np.arange(largest + 1)))
    sums = []
    for one, trust in zip(h, weight, strict=True):
        x = line_weights(one, trust)[:, None] * z
        y = -one[:, None] * x
        sums.append((x.conj().T @ x, x.conj().T @ y, y.conj().T @ y))
    result = []
    for order in ORDERS:
        if order > largest:
            break
        n = order + 1
        reduced = sum(
            t[:n, :n] - s[:n, :n].conj().T @ np.linalg.lstsq(r[:n, :n], s[:n, :n], rcond=None)[0]
            for r, s, t in sums
        )
        # The highest coefficient is one: poles that only fit noise then come out unstable.
        a = np.ones(n, dtype=np.complex128)
        a[:-1] = np.linalg.lstsq(reduced[:-1, :-1], -reduced[:-1, -1], rcond=None)[0]
        roots = np.roots(a[::-1])
        s = -np.log(roots[roots != 0]) / duration + 2j * np.pi * f[0]
        natural = np.abs(s)
        ratio = -s.real / natural
        keep = (ratio > 0.0) & (ratio < LARGEST_DAMPING)
        keep &= (s.imag > 2 * np.pi * f[0]) & (s.imag < 2 * np.pi * f[-1])
        result.append((natural[keep] / (2 * np.pi), ratio[keep]))
    return result


def _lasting(
    by_order: list[tuple[NDArray[np.float64], NDArray[np.float64]]],
) -> list[Pole]:
    """Poles that stay through several orders: frequency, damping ratio, number of orders."""
    chains: list[list[tuple[float, float]]] = []
    alive: list[list[tuple[float, float]]] = []
    for frequencies, ratios in by_order:
        going: list[list[tuple[float, float]]] = []
        taken: set[int] = set()
        for frequency, ratio in zip(frequencies.tolist(), ratios.tolist(), strict=True):
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
                going.append(alive[i])
            else:
                chains.append([(frequency, ratio)])
                going.append(chains[-1])
        alive = going
    lasting = [chain for chain in chains if len(chain) >= LASTING]
    return [
        Pole(
            float(np.median([f for f, _ in chain[len(chain) // 2 :]])),
            float(np.median([z for _, z in chain[len(chain) // 2 :]])),
            len(chain),
        )
        for chain in lasting
    ]


def _merged(known: list[Pole], new: list[Pole]) -> list[Pole]:
    """Known poles, and the new ones that are neither one of them nor a chain broken in two."""
    kept = list(known)
    for pole in sorted(new, key=lambda pole: -pole.orders):
        f, width = pole.frequency, pole.damping_ratio * pole.frequency
        apart = max(width, SAME_FREQUENCY * f)
        if all(abs(f - other.frequency) > apart for other in known) and all(
            abs(f - other.frequency) > 0.5 * width for other in kept
        ):
            kept.append(pole)
    return kept

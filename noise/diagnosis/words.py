"""Words for causes, stages, probabilities and numbers of a diagnosis."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from noise.base import packaged_toml
from noise.diagnosis.outcome import LARGEST_GAP

PHASES = {
    "stick": "while the contact sticks",
    "slip": "while the contact slips",
    "cycle": "in the stick-slip cycle as a whole",
}
"""Phases of the stick-slip cycle in words."""


def parameter_name(name: str) -> str:
    """Return a parameter's name in words.

    Examples
    --------
    >>> parameter_name("elastomer_stiffness")
    'elastomer stiffness'
    """
    return name.replace("_", " ")


NOT_DETERMINED = "not determined"
"""Text for an unknown figure."""


class Cause(NamedTuple):
    """Name and description of a cause."""

    name: str
    clause: str


CAUSES = {
    name: Cause(*words)
    for name, words in packaged_toml("noise.diagnosis", "cause_names.toml").items()
}
"""Descriptions of all shipped effects and of the other verdicts, by name."""

STAGES = {
    "drive": "the shaft's motion",
    "friction": "contact, elastomer",
    "structure": "clamp and beams",
    "radiation": "plate and room",
    "measurement": "sensors and cables",
}
"""Descriptions of the stages, in the order of the chain."""


def cause_of(name: str) -> Cause:
    """Return the description of a cause; one that is not shipped is the user's own.

    Examples
    --------
    >>> cause_of("mains_hum").name, cause_of("zero_offset").clause
    ('mains hum', 'an effect of your own')
    """
    return CAUSES.get(name) or Cause(name.replace("_", " "), "an effect of your own")


def p_number(p_value: float) -> str:
    """Return a p-value as text.

    Examples
    --------
    >>> p_number(0.4), p_number(0.0123), p_number(0.00042), p_number(1e-7)
    ('p = 0.40', 'p = 0.012', 'p = 0.0004', 'p < 0.0001')
    """
    if not math.isfinite(p_value):
        return f"p {NOT_DETERMINED}"
    if p_value < 1e-4:
        return "p < 0.0001"
    return f"p = {p_value:.{2 if p_value >= 0.1 else 3 if p_value >= 0.01 else 4}f}"


def percent(share: float | None) -> str:
    """Return a share in per cent; rounding never gives 0 or 100 %.

    Examples
    --------
    >>> percent(0.5), percent(0.996), percent(0.001), percent(-0.2), percent(None)
    ('50 %', '> 99 %', '< 1 %', '−20 %', 'not determined')
    """
    if share is None or not math.isfinite(share):
        return NOT_DETERMINED
    if 0.0 < share < 0.01:
        return "< 1 %"
    if 0.99 < share < 1.0:
        return "> 99 %"
    return f"{100 * share:.0f} %".replace("-", "\N{MINUS SIGN}")


def number(value: float | None, form: str = ".2f") -> str:
    """Return a number [any unit] as text.

    Examples
    --------
    >>> number(-1.234), number(None)
    ('−1.23', 'not determined')
    """
    if value is None or not math.isfinite(value):
        return NOT_DETERMINED
    return format(value, form).replace("-", "\N{MINUS SIGN}")


def gap_number(gap: float | None, form: str = ".1f") -> str:
    """Return a gap [-], relative to that of repeats of one run, as text.

    Examples
    --------
    >>> gap_number(1.23), gap_number(100.0), gap_number(None)
    ('1.2', 'more than 100', 'not determined')
    """
    if gap is not None and gap >= LARGEST_GAP:
        return f"more than {LARGEST_GAP:g}"
    return number(gap, form)


def frequency(hertz: float) -> str:
    """Return a frequency [Hz] as text.

    Examples
    --------
    >>> frequency(50.0), frequency(1800.0), frequency(15e3)
    ('50 Hz', '1.8 kHz', '15 kHz')
    """
    return f"{hertz / 1e3:.3g} kHz" if hertz >= 1e3 else f"{hertz:.3g} Hz"


def joined(words: Sequence[str], last: str = "and") -> str:
    """Return an enumeration.

    Examples
    --------
    >>> joined(["a", "b", "c"]), joined(["a"])
    ('a, b and c', 'a')
    """
    if len(words) < 2:
        return "".join(words)
    return f"{', '.join(words[:-1])} {last} {words[-1]}"

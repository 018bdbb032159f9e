"""Words for causes, stages, probabilities and numbers of a diagnosis.

Each cause has a name and a clause that describes it. Probabilities are worded by the scale of the
Intergovernmental Panel on Climate Change (Mastrandrea et al. 2010, Guidance note on consistent
treatment of uncertainties); the number always follows the word.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from noise.base import packaged_toml
from noise.diagnosis.outcome import LARGEST_GAP, SURE, Diagnosis, EffectFinding
from sim.effects import EFFECTS

PHASES = {
    "stick": "while the contact sticks",
    "slip": "while the contact slips",
    "cycle": "in the stick-slip cycle as a whole",
}
"""Phases of the stick-slip cycle in words."""


def stage_of_effect(diagnosis: Diagnosis, name: str) -> str:
    """Return the stage that an effect acts in; empty if it is unknown."""
    finding = finding_of(diagnosis, name)
    if finding is not None:
        return str(finding.stage)
    return str(EFFECTS[name].stage) if name in EFFECTS else ""


def begins(diagnosis: Diagnosis) -> bool:
    """Return whether the gap begins in the stage of its location.

    It does if that stage differs significantly and effects of the verdict, if any, act there.

    Examples
    --------
    >>> from noise.diagnosis.outcome import Diagnosis
    >>> begins(Diagnosis((), (), None, {}, (), {"none": 1.0}, {}, "", (), 0.9, 1.0, 0.6, 1.0))
    False
    """
    place = diagnosis.location
    if place is None or place.p_value > SURE:
        return False
    acting = {stage_of_effect(diagnosis, name) for name in diagnosis.verdict} - {""}
    return not acting or place.stage in acting


def finding_of(diagnosis: Diagnosis, name: str) -> EffectFinding | None:
    """Return the finding about an effect, if there is one."""
    return next((effect for effect in diagnosis.effects if effect.name == name), None)


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


@dataclass(frozen=True)
class Cause:
    """Name and description of a cause."""

    name: str
    clause: str


CAUSES = {
    name: Cause(*words)
    for name, words in packaged_toml("noise.diagnosis.text", "causes.toml").items()
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

_CHANCES = (
    (0.99, "virtually certain"),
    (0.90, "very likely"),
    (0.66, "likely"),
    (0.33, "about as likely as not"),
    (0.10, "unlikely"),
    (0.01, "very unlikely"),
    (-math.inf, "exceptionally unlikely"),
)

_EVIDENCE = (
    (0.001, "repeats would hardly ever differ as much"),
    (0.01, "repeats would very seldom differ as much"),
    (0.05, "repeats would seldom differ as much"),
    (0.2, "about 1 in {n} sets of repeats differs as much"),
    (math.inf, "repeats often differ as much"),
)


def cause_of(name: str) -> Cause:
    """Return the description of a cause; one that is not shipped is the user's own.

    Examples
    --------
    >>> cause_of("mains_hum").name, cause_of("zero_offset").clause
    ('mains hum', 'an effect of your own')
    """
    return CAUSES.get(name) or Cause(name.replace("_", " "), "an effect of your own")


def chance(probability: float) -> str:
    """Return a probability as a word and a number.

    Examples
    --------
    >>> chance(0.96), chance(0.999), chance(0.004)
    ('very likely, 96 %', 'virtually certain, > 99 %', 'exceptionally unlikely, < 1 %')
    """
    word = next(word for least, word in _CHANCES if probability >= least)
    return f"{word}, {percent(probability)}"


def evidence(p_value: float) -> str:
    """Return a p-value as words.

    Examples
    --------
    >>> evidence(0.0004), evidence(0.07), evidence(0.4)
    ('repeats would hardly ever differ as much', 'about 1 in 14 sets of repeats differs as much',
      'repeats often differ as much')
    """
    if not math.isfinite(p_value):
        return NOT_DETERMINED
    words = next(words for below, words in _EVIDENCE if p_value < below)
    return words.format(n=round(1.0 / max(p_value, 1e-9)))


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


def joined(words: list[str] | tuple[str, ...], last: str = "and") -> str:
    """Return an enumeration.

    Examples
    --------
    >>> joined(["a", "b", "c"]), joined(["a"])
    ('a, b and c', 'a')
    """
    if len(words) < 2:
        return "".join(words)
    return f"{', '.join(words[:-1])} {last} {words[-1]}"

"""Recordings beside their simulations on the page of a diagnosis: pictures and sounds."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from noise.diagnosis.findings import ROLES
from noise.pages.diagnosis.contact_figures import contact_panels
from noise.pages.diagnosis.figures import CURVES, illustration_panels
from noise.pages.diagnosis.sounds import illustration_entries
from noise.pages.engine.clips import common_gain, make_clips
from noise.pages.engine.entry import Entry
from noise.pages.engine.entry_display import facts_of

if TYPE_CHECKING:
    from noise.diagnosis.outcome import Diagnosis
    from noise.pages.engine.clips import Clip
    from noise.pages.engine.panels import Panel

__all__ = ["Comparison", "draw_comparisons"]


class Comparison(NamedTuple):
    """One recording beside its simulations; `sounds` are ids by role."""

    name: str
    condition: str
    roles: tuple[str, ...]
    sounds: dict[str, str]
    panels: tuple[Panel, ...]


def draw_comparisons(
    diagnosis: Diagnosis,
) -> tuple[dict[str, Entry], dict[str, Clip], dict[str, object]]:
    """Draw and sound what a diagnosis illustrates.

    Parameters
    ----------
    diagnosis : Diagnosis

    Returns
    -------
    entries : dict of str to Entry
        By id.
    clips : dict of str to Clip
        Of those that can be heard.
    contents : dict of str to object
        What the template names: ``comparisons``, ``curves`` and ``gain``.

    Raises
    ------
    ParameterError
        A signal that cannot be analysed.
    """
    entries: dict[str, Entry] = {}
    comparisons = []
    for illustration in diagnosis.illustrations:
        found = illustration_entries(illustration, diagnosis.labels_and_levels)
        keys = {role: f"s{len(entries) + i}" for i, role in enumerate(found, 1)}
        entries |= {keys[role]: entry for role, entry in found.items()}
        known = facts_of(Entry(illustration.name, condition=illustration.measured.condition))
        comparisons.append(
            Comparison(
                illustration.name,
                ", ".join(fact.words for name, fact in known.items() if name != "material"),
                ROLES if illustration.after is not None else ROLES[:2],
                keys,
                (*illustration_panels(illustration), *contact_panels(illustration.contacts)),
            )
        )
    gain = common_gain(entries.values())
    clips, _ = make_clips(entries, gain)
    sentences = gain.sentences if clips else ()
    return entries, clips, {"comparisons": comparisons, "curves": CURVES, "gain": sentences}

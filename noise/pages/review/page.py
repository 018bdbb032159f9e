"""The page of a review, from its template."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from noise.labels.label_display import LABEL_LOOKS
from noise.pages.review.equal import MOST_RAISED, equal_factors
from noise.pages.review.maps import HEIGHT, WIDTH
from noise.pages.review.spectrogram import RANGE, scale_picture
from noise.pages.review.view import card_of, draw_pictures, frequency_ticks, scale_words
from noise.pages.templating import as_base64, template

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from noise.pages.review.clips import Clip, Gain
    from noise.pages.review.diagnoses import ShownDiagnosis
    from noise.pages.review.entries import Entry
    from noise.pages.review.inputs import Refusal
    from noise.pages.review.maps import ConditionMap
    from noise.pages.review.view import Card

__all__ = ["Contents", "page_html"]


@dataclass(frozen=True)
class Contents:
    """All that is on the page.

    Parameters
    ----------
    title, summary : str
    gain : Gain
    shortened : float or None
        To how many seconds the sounds were cut.
    entries, clips : mapping by id
        Clips of those that can be heard.
    groups : mapping of str to sequence of str
        Ids of ``recorded`` and of ``diagnosis 0`` and so on.
    diagnoses : tuple of ShownDiagnosis
    recorded_maps, screened_maps : tuple of ConditionMap
    unplaced : int
        Recordings whose conditions are not known.
    refused : tuple of Refusal
    """

    title: str
    summary: str
    gain: Gain
    shortened: float | None
    entries: Mapping[str, Entry]
    clips: Mapping[str, Clip]
    groups: Mapping[str, Sequence[str]]
    diagnoses: tuple[ShownDiagnosis, ...]
    recorded_maps: tuple[ConditionMap, ...]
    unplaced: int
    screened_maps: tuple[ConditionMap, ...]
    refused: tuple[Refusal, ...]


def page_html(contents: Contents) -> str:
    """Return the page."""
    entries, clips = contents.entries, contents.clips
    cards = {key: card_of(key, entry, clips.get(key)) for key, entry in entries.items()}
    pictures = draw_pictures(entries, clips)
    factors, target = equal_factors(
        {
            key: clip.samples.astype(np.float64) / contents.gain.of(entries[key])
            for key, clip in clips.items()
        }
    )
    on_cards = {key for keys in contents.groups.values() for key in keys}
    return template("review.html.j2").render(
        title=contents.title,
        summary=contents.summary,
        gain=contents.gain.sentences if clips else (),
        shortened=contents.shortened,
        refused=contents.refused,
        recorded=[cards[key] for key in contents.groups["recorded"]],
        recorded_maps=contents.recorded_maps,
        unplaced=contents.unplaced,
        screened_maps=contents.screened_maps,
        diagnoses=[
            (shown, [cards[key] for key in contents.groups[f"diagnosis {i}"]])
            for i, shown in enumerate(contents.diagnoses)
        ],
        pictures=pictures.by_id,
        scale=as_base64(scale_picture()),
        scale_words=scale_words(pictures, RANGE),
        frequencies=frequency_ticks(),
        sounds={key: as_base64(clip.flac) for key, clip in clips.items()},
        about={
            key: _about(
                cards[key], factors.get(key), None if key in on_cards else pictures.by_id[key]
            )
            for key in clips
        },
        equal=_equal(len(factors), len(clips), target),
        counts=_counts([cards[key] for key in contents.groups["recorded"]]),
        width=WIDTH,
        height=HEIGHT,
    )


def _about(card: Card, factor: float | None, picture: str | None) -> dict[str, object]:
    """Tell the player of a sound."""
    told: dict[str, object] = {
        "title": card.title,
        "label": card.label,
        "facts": " · ".join(card.facts) if picture is None else "simulated",
        "duration": card.duration,
        "equal": factor,
    }
    return told if picture is None else told | {"picture": picture}


def _equal(n_equal: int, n_sounds: int, target: float) -> str:
    """Say what the button of equal loudness does; nothing where there is nothing to compare."""
    if n_equal < 2:
        return ""
    left = n_sounds - n_equal
    rest = (
        f"; {left} shorter than 0.4 s or softer by {MOST_RAISED:g} dB stay as they are"
        if left
        else ""
    )
    return f"{target:.0f} LUFS (ITU-R BS.1770){rest}".replace("-", "\N{MINUS SIGN}", 1)


def _counts(cards: Sequence[Card]) -> list[tuple[str, int]]:
    """How many recordings have which label, if there are several labels."""
    counts = Counter(card.label or "" for card in cards)
    found = [(label, counts[label]) for label in (*LABEL_LOOKS, "") if counts[label]]
    return found if len(found) > 1 else []

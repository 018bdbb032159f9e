"""Display of a trained model in a notebook: how it was trained, and how well it did."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from models.html_table import html_table

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = ["model_display"]


def model_display(name: str, facts: Sequence[Sequence[str]], card: Mapping[str, object]) -> str:
    """Return a model's card as a table in HTML; of what is nested, the numbers of the first level.

    Parameters
    ----------
    name : str
        What it is.
    facts : sequence of pairs of str
        What stands above the card's own.
    card : mapping
        How it was trained.

    Returns
    -------
    str

    Examples
    --------
    >>> table = model_display("Classifier", [], {"seed": 3, "sound": {"accuracy": 0.91234}})
    >>> "accuracy 0.912" in table, "seed" in table
    (True, True)
    """
    rows = [[key.replace("_", " "), _words(value)] for key, value in card.items()]
    return html_table(name, [*facts, *(row for row in rows if row[1])])


def _words(value: object) -> str:
    if isinstance(value, Mapping):
        named = [(key, inner) for key, inner in value.items() if isinstance(inner, int | float)]
        return ", ".join(f"{str(key).replace('_', ' ')} {_number(inner)}" for key, inner in named)
    return _number(value) if isinstance(value, int | float) else str(value)


def _number(value: float) -> str:
    return f"{value:.3g}" if isinstance(value, float) else str(value)

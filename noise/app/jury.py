"""Jury tests: blind paired comparisons in random order, their votes, and the resulting scale.

All comparisons are in the table of votes from the beginning, without a vote, so whoever goes on
with a jury goes on in its order; each vote is in the table before it is answered. The table is read
anew each time, as others may write it, and written whole or not at all. Columns of one's own stay.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import datetime
from itertools import combinations, groupby, pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from models.errors import ParameterError, RecordingError
from noise.base.files import locked
from noise.base.tables import read_table, write_table

Row = dict[str, Any]

COLUMNS = (
    *("jury", "listener", "question", "played", "seed"),
    *("order", "first", "second", "vote", "seconds", "time"),
)
"""Of the table of votes, one row per comparison; those that wait have no vote."""

VOTES = {"first": 1.0, "second": 0.0, "equal": 0.5}
"""What is voted for: the sound that is called A, the one that is called B, no difference; and the
share of the vote that A has."""

_DRAWS = 1000
"""Of the bootstrap [-]."""

_PRIOR = 0.5
"""Votes of each sound for and against a sound of value zero: they keep every value finite [-]."""


@dataclass(frozen=True)
class Jury:
    """Comparisons of one person in their order; votes exist for the first ones.

    Parameters
    ----------
    number : int
        Number of the jury.
    listener, question : str
    played : str
        At which gain.
    pairs : tuple of (str, str)
        Names of sounds A and B of each comparison.
    votes : tuple of str
        Votes so far, of `VOTES`.

    Examples
    --------
    >>> pairs = ("a.wav", "b.wav"), ("c.wav", "b.wav")
    >>> jury = Jury(1, "", "Which is louder?", "one gain", pairs, ("first",))
    >>> jury.sounds, jury.waiting
    (('a.wav', 'b.wav', 'c.wav'), 1)
    """

    number: int
    listener: str
    question: str
    played: str
    pairs: tuple[tuple[str, str], ...]
    votes: tuple[str, ...]

    @property
    def sounds(self) -> tuple[str, ...]:
        """Names of all sounds, sorted."""
        return tuple(sorted({name for pair in self.pairs for name in pair}))

    @property
    def waiting(self) -> int | None:
        """Index of the next comparison; None if all are voted."""
        return len(self.votes) if len(self.votes) < len(self.pairs) else None


class Votes:
    """Table of votes, safe for several threads and programs.

    Parameters
    ----------
    path : Path
        File, which need not exist.
    """

    def __init__(self, path: Path) -> None:
        self.path = path

    def juries(self) -> list[Jury]:
        """Return all juries of the table.

        Raises
        ------
        RecordingError
            The file is not a table of votes.
        """
        return [_jury(self.path, rows) for rows in self._read()[1].values()]

    def jury(self, number: int) -> Jury:
        """Return a jury.

        Raises
        ------
        ParameterError
            The jury does not exist.
        RecordingError
            The file is not a table of votes.
        """
        return _jury(self.path, _rows_of(self._read()[1], number))

    def begin(
        self,
        names: Sequence[str],
        *,
        listener: str,
        question: str,
        played: str,
        seed: int,
        comparisons: int | None = None,
    ) -> Jury:
        """Write a new jury and return it.

        Parameters
        ----------
        names : sequence of str
            Of the sounds.
        listener, question, played
            As of `Jury`.
        seed : int
            Of the order, with the number of the jury.
        comparisons : int, optional
            As of `random_pairs` [-].

        Raises
        ------
        ParameterError
            The table cannot be written.
        RecordingError
            What stands there is no table of votes.
        """
        about = {"listener": listener, "question": question, "played": played, "seed": seed}
        with self._changed() as juries:
            number = max(juries, default=0) + 1
            pairs = random_pairs(names, np.random.default_rng([seed, number]), comparisons)
            juries[number] = [
                {"jury": number, **about, "order": order, "first": first, "second": second}
                for order, (first, second) in enumerate(pairs, start=1)
            ]
        return self.jury(number)

    def vote(self, number: int, place: int, vote: str, seconds: float) -> Jury:
        """Write a vote and return the jury with it.

        Parameters
        ----------
        number : int
            Of the jury.
        place : int
            Of the comparison, which has to be the one whose turn it is.
        vote : str
            One of `VOTES`.
        seconds : float
            For which it was listened to [s].

        Raises
        ------
        ParameterError
            It is another's turn, or the table cannot be written; then all is as it was.
        RecordingError
            Somebody else has made something of the table that is none.
        """
        if vote not in VOTES:
            raise ParameterError(f"vote {vote!r}: must be one of {', '.join(VOTES)}")
        with self._changed() as juries:
            rows = _rows_of(juries, number)
            if _jury(self.path, rows).waiting != place:
                raise ParameterError(f"comparison {place + 1} is not the one whose turn it is")
            now = datetime.now().astimezone().isoformat(timespec="seconds")
            rows[place] |= {"vote": vote, "seconds": round(seconds, 2), "time": now}
            return _jury(self.path, rows)

    @contextmanager
    def _changed(self) -> Iterator[dict[int, list[Row]]]:
        """Yield the rows of each jury for changes, then write them."""
        with locked(self.path):
            columns, juries = self._read()
            yield juries
            more = tuple(name for name in columns if name not in COLUMNS)
            write_table(
                self.path, (*COLUMNS, *more), [row for rows in juries.values() for row in rows]
            )

    def _read(self) -> tuple[list[str], dict[int, list[Row]]]:
        if not self.path.exists():
            return [], {}
        columns, rows = read_table(self.path)
        missing = [name for name in COLUMNS if name not in columns]
        if missing:
            raise RecordingError(f"{self.path}: is no table of votes; it lacks {missing[0]}")
        for line, row in enumerate(rows, start=2):
            for name in ("jury", "order"):
                text = str(row[name])
                if not (text.isascii() and text.isdecimal() and 0 < len(text) < 10):
                    raise RecordingError(f"{self.path}, line {line}: {name} {text!r} is no number")
        rows.sort(key=_place)
        return columns, {number: list(of) for number, of in groupby(rows, lambda r: _place(r)[0])}


def random_pairs(
    names: Sequence[str], rng: np.random.Generator, count: int | None = None
) -> list[tuple[str, str]]:
    """Return pairs of sounds in random order and orientation.

    Parameters
    ----------
    names : sequence of str
    rng : Generator
    count : int, optional
        Of the pairs, from one less than sounds; these join all sounds [-]. By default all pairs.

    Raises
    ------
    ParameterError
        There are not so many pairs, or so few leave a sound out.

    Examples
    --------
    >>> random_pairs("abc", np.random.default_rng(1))
    [('b', 'a'), ('a', 'c'), ('c', 'b')]
    >>> len(random_pairs("abcd", np.random.default_rng(1), 3))
    3
    """
    pairs = list(combinations(names, 2))
    if count is not None and not len(names) - 1 <= count <= len(pairs):
        raise ParameterError(
            f"{count} comparisons: {len(names)} sounds need {len(names) - 1} to {len(pairs)}"
        )
    chain: set[tuple[int, ...]] = set()
    if count is not None and count < len(pairs):
        order = rng.permutation(len(names))
        chain = {tuple(sorted(two)) for two in pairwise(order.tolist())}
    places = dict(zip(pairs, combinations(range(len(names)), 2), strict=True))
    shuffled = [pairs[place] for place in rng.permutation(len(pairs))]
    if chain:
        shuffled.sort(key=lambda pair: places[pair] not in chain)
        shuffled = [shuffled[place] for place in rng.permutation(count or 0)]
    return [pair[::-1] if rng.random() < 0.5 else pair for pair in shuffled]


def bradley_terry(share: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return Bradley-Terry values of sounds; odds of a choice are exp(difference).

    Parameters
    ----------
    share : ndarray, shape (..., n, n)
        Votes for the sound of the row against that of the column [-]; one half for no difference.

    Returns
    -------
    ndarray, shape (..., n)
        Their mean is zero [-].

    Notes
    -----
    R. A. Bradley, M. E. Terry, Biometrika 39 (1952) 324; the likelihood has one more vote of each
    sound, half for and half against a sound of value zero, so that one which won all its
    comparisons has a finite value.

    Examples
    --------
    >>> loud, calm = bradley_terry(np.array([[0.0, 700.0], [300.0, 0.0]]))
    >>> round(float(loud - calm), 2)  # log(7 / 3)
    0.85
    """
    total = share + np.swapaxes(share, -1, -2)
    value = np.zeros(share.shape[:-1])
    diagonal = np.eye(share.shape[-1])
    for _ in range(50):
        p = 1.0 / (1.0 + np.exp(value[..., None, :] - value[..., :, None]))
        own = 1.0 / (1.0 + np.exp(-value))
        slope = (share - total * p).sum(axis=-1) + _PRIOR * (1.0 - 2.0 * own)
        weight = total * p * (1.0 - p)
        curvature = weight.sum(axis=-1) + 2.0 * _PRIOR * own * (1.0 - own)
        step = np.linalg.solve(diagonal * curvature[..., None, :] - weight, slope[..., None])
        step = np.clip(step[..., 0], -2.0, 2.0)
        value = value + step
        if np.abs(step).max() < 1e-9:
            break
    return np.asarray(value - value.mean(axis=-1, keepdims=True))


def scale(jury: Jury) -> list[Row]:
    """Return the Bradley-Terry scale of a jury, highest first; sounds without a vote come last.

    Intervals at 95 % are those of a bootstrap: votes on the same pairs are drawn anew by the values
    found. They say how surely these votes place a sound, not how another person would vote.

    Parameters
    ----------
    jury : Jury

    Examples
    --------
    >>> pairs = ("calm", "loud"), ("loud", "calm")
    >>> rows = scale(Jury(1, "", "Which is louder?", "one gain", pairs, ("second", "first")))
    >>> [row["sound"] for row in rows], rows[0]["chosen"], rows[0]["not_chosen"]
    (['loud', 'calm'], 2, 0)
    """
    names = jury.sounds
    n = len(names)
    at = {name: number for number, name in enumerate(names)}
    pairs = np.array([(at[a], at[b]) for a, b in jury.pairs[: len(jury.votes)]], int).reshape(-1, 2)
    shares = np.array([VOTES[vote] for vote in jury.votes])
    decided = shares != VOTES["equal"]
    wins, ties = (_counted(pairs[which], shares[which], n) for which in (decided, ~decided))
    value = bradley_terry(wins + ties)
    rng = np.random.default_rng(jury.number)
    likely = 1.0 / (1.0 + np.exp(value[pairs[:, 1]] - value[pairs[:, 0]]))
    drawn = (rng.random((_DRAWS, len(pairs))) < likely).astype(float)
    again = bradley_terry(np.array([_counted(pairs, one, n) for one in drawn]))
    places = np.column_stack((value, *np.quantile(again, (0.025, 0.975), axis=0)))
    joined = np.asarray(wins + wins.T + ties) > 0.0
    compared: list[bool] = np.any(joined, axis=1).tolist()
    order = sorted(range(n), key=lambda one: (not compared[one], -value[one], names[one]))
    return [
        {
            "sound": names[one],
            **dict.fromkeys(("value", "low_95", "high_95")),
            **{
                name: round(float(place), 2) + 0.0
                for name, place in zip(("value", "low_95", "high_95"), places[one], strict=True)
                if compared[one]
            },
            "chosen": int(wins[one].sum()),
            "not_chosen": int(wins[:, one].sum()),
            "no_difference": int(2.0 * ties[one].sum()),
        }
        for one in order
    ]


def in_words(rows: Sequence[Row]) -> str:
    """Return the result of a jury in words, from the rows of `scale`.

    Examples
    --------
    >>> row = {"value": 1.5, "low_95": 0.9, "high_95": 2.1, "chosen": 5, "not_chosen": 1}
    >>> last = {"value": -1.5, "low_95": -2.0, "high_95": -0.8, "chosen": 1, "not_chosen": 5}
    >>> same = {"no_difference": 0}
    >>> in_words([row | same | {"sound": "loud"}, last | same | {"sound": "calm"}])
    'loud comes first: chosen in 5 of 6 comparisons. It is clearly ahead of calm.'
    """
    placed = [row for row in rows if row["value"] is not None]
    if len(placed) < 2:
        return "No votes yet."
    first, last = placed[0], placed[-1]

    def share(row: Row) -> str:
        count = row["chosen"] + row["not_chosen"] + row["no_difference"]
        return f"chosen in {row['chosen']} of {count} comparison{'s' * (count != 1)}"

    close = [row["sound"] for row in placed[1:] if row["high_95"] >= first["low_95"]]
    texts = [f"{first['sound']} comes first: {share(first)}."]
    if not close:
        rest = placed[1]["sound"] if len(placed) == 2 else "all others"
        texts.append(f"It is clearly ahead of {rest}.")
    elif len(close) == len(placed) - 1:
        texts.append("These votes do not separate it clearly from any other sound.")
    else:
        texts.append(f"Its lead over {', '.join(close)} is not clear yet.")
    if len(placed) > 2:
        texts.append(f"{last['sound']} comes last: {share(last)}.")
    return " ".join(texts)


def _counted(pairs: NDArray[np.int64], shares: NDArray[np.float64], n: int) -> NDArray[np.float64]:
    counts = np.zeros((n, n))
    np.add.at(counts, (pairs[:, 0], pairs[:, 1]), shares)
    np.add.at(counts, (pairs[:, 1], pairs[:, 0]), 1.0 - shares)
    return counts


def _place(row: Row) -> tuple[int, int]:
    return int(str(row["jury"])), int(str(row["order"]))


def _rows_of(juries: dict[int, list[Row]], number: int) -> list[Row]:
    if number not in juries:
        raise ParameterError(f"there is no jury {number}")
    return juries[number]


def _jury(path: Path, rows: Sequence[Row]) -> Jury:
    number = _place(rows[0])[0]
    votes = [str(row["vote"] or "") for row in rows]
    voted = next((place for place, vote in enumerate(votes) if not vote), len(votes))
    wrong = next((vote for vote in votes[:voted] if vote not in VOTES), None)
    if wrong is not None or any(votes[voted:]):
        what = "a vote after one that is missing" if wrong is None else f"the vote {wrong!r}"
        raise RecordingError(
            f"{path}: jury {number} has {what}; votes are {', '.join(VOTES)}, from the first on"
        )
    listener, question, played = (str(rows[0][c] or "") for c in ("listener", "question", "played"))
    pairs = tuple((str(row["first"] or ""), str(row["second"] or "")) for row in rows)
    if any("" in pair or pair[0] == pair[1] for pair in pairs):
        raise RecordingError(f"{path}: jury {number} has a row without two different sounds")
    return Jury(number, listener, question, played, pairs, tuple(votes[:voted]))

"""Juries and their votes in a table: each vote is in it before it is answered.

A jury's comparisons are all in the table from its beginning, in their random order and without a
vote, so whoever goes on with it goes on in that order. The table is read anew each time, as others
may write it; it is written whole or not at all. Columns of one's own stay in it.
"""

from __future__ import annotations

from contextlib import contextmanager
from dataclasses import dataclass
from datetime import datetime
from itertools import groupby
from typing import TYPE_CHECKING

from models.errors import ParameterError, RecordingError
from noise.app.jury.votes import VOTES, Vote
from noise.base.lock import locked
from noise.base.tables import read_table, write_table

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence
    from pathlib import Path

    from noise.app.jury.order import Pair

    Row = dict[str, object]

__all__ = ["COLUMNS", "Jury", "Votes"]

COLUMNS = (
    *("jury", "listener", "question", "played", "seed"),
    *("order", "first", "second", "vote", "seconds", "time"),
)
"""Of the table, one row a comparison; those that wait have no vote."""


@dataclass(frozen=True)
class Jury:
    """Comparisons by one person, in their order, of which the first have been voted.

    Parameters
    ----------
    number : int
        By which it is called.
    listener, question : str
    played : str
        At which gain, one of `noise.app.jury.playing.GAINS`.
    pairs : tuple of (str, str)
        Names of the sounds that are called A and B.
    votes : tuple of str
        One of `VOTES` each; as many as were voted.
    last_time : str
        When the last of them was given, as it stands in the table: it tells that vote from another
        which was given in its place.

    Examples
    --------
    >>> pairs = ("a.wav", "b.wav"), ("c.wav", "b.wav")
    >>> jury = Jury(1, "", "Which is louder?", "one gain", pairs, ("first",))
    >>> jury.sounds, jury.waiting, jury.said[0].chosen
    (('a.wav', 'b.wav', 'c.wav'), 1, 0)
    """

    number: int
    listener: str
    question: str
    played: str
    pairs: tuple[tuple[str, str], ...]
    votes: tuple[str, ...]
    last_time: str = ""

    @property
    def sounds(self) -> tuple[str, ...]:
        """Names of all sounds, each once, in the order of their names."""
        return tuple(sorted({name for pair in self.pairs for name in pair}))

    @property
    def waiting(self) -> int | None:
        """Number of the comparison whose turn it is; None where all have been voted."""
        return len(self.votes) if len(self.votes) < len(self.pairs) else None

    @property
    def said(self) -> tuple[Vote, ...]:
        """Votes by numbers among `sounds`."""
        at = {name: number for number, name in enumerate(self.sounds)}
        voted = zip(self.pairs, self.votes, strict=False)
        return tuple(Vote(at[first], at[second], vote) for (first, second), vote in voted)


class Votes:
    """The table of votes; may be used from several threads and programs.

    Parameters
    ----------
    path : Path
        There, or to be made.
    """

    def __init__(self, path: Path) -> None:
        self.path = path

    def juries(self) -> list[Jury]:
        """Return all juries, as they stand in the table.

        Raises
        ------
        RecordingError
            It is no table of votes.
        """
        return [_jury(self.path, rows) for rows in self._read()[1].values()]

    def jury(self, number: int) -> Jury:
        """Return a jury.

        Raises
        ------
        ParameterError
            There is none of this number.
        RecordingError
            It is no table of votes.
        """
        return _jury(self.path, _rows_of(self._read()[1], number))

    def begin(
        self,
        names: Sequence[str],
        drawn: Callable[[int], Sequence[Pair]],
        *,
        listener: str,
        question: str,
        played: str,
        seed: int,
    ) -> Jury:
        """Write a new jury and return it.

        Parameters
        ----------
        names : sequence of str
            Of the sounds.
        drawn : callable
            From the number of the jury to its comparisons in their order, each of them the numbers
            among `names` of the first and the second sound.
        listener, question, played
            As of `Jury`.
        seed : int
            Of the order, with the number of the jury.

        Raises
        ------
        ParameterError
            The table cannot be written.
        RecordingError
            What stands there is no table of votes.
        """
        with self._changed() as juries:
            number = max(juries, default=0) + 1
            about = {"listener": listener, "question": question, "played": played, "seed": seed}
            juries[number] = [
                {"jury": number, **about, "order": order, "first": names[a], "second": names[b]}
                for order, (a, b) in enumerate(drawn(number), start=1)
            ]
        return self.jury(number)

    def vote(self, number: int, place: int, said: str, seconds: float) -> Jury:
        """Write a vote and return the jury with it.

        Parameters
        ----------
        number : int
            Of the jury.
        place : int
            Of the comparison, which has to be the one whose turn it is.
        said : str
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
        if said not in VOTES:
            raise ParameterError(f"vote {said!r}: must be one of {', '.join(VOTES)}")
        with self._changed() as juries:
            rows = _rows_of(juries, number)
            jury = _jury(self.path, rows)
            if jury.waiting != place:
                raise ParameterError(f"comparison {place + 1} is not the one whose turn it is")
            now = datetime.now().astimezone().isoformat(timespec="milliseconds")
            rows[place] |= {"vote": said, "seconds": round(seconds, 2), "time": now}
            return _jury(self.path, rows)  # not as others may have made it since

    def undo(self, number: int, place: int, time: str) -> Jury:
        """Take back the last vote of a jury and return the jury without it.

        Parameters
        ----------
        number : int
            Of the jury.
        place : int
            Of the comparison whose vote is meant.
        time : str
            When that vote was given, the `last_time` of a jury that has it.

        Raises
        ------
        ParameterError
            That vote is not the last one, or the table cannot be written; then all is as it was.
        RecordingError
            Somebody else has made something of the table that is none.
        """
        with self._changed() as juries:
            rows = _rows_of(juries, number)
            jury = _jury(self.path, rows)
            if (len(jury.votes) - 1, jury.last_time) != (place, time):
                raise ParameterError(
                    f"the vote on comparison {place + 1} that was to be undone is not the last one "
                    "any more"
                )
            rows[place] |= {"vote": None, "seconds": None, "time": None}
            return _jury(self.path, rows)

    @contextmanager
    def _changed(self) -> Iterator[dict[int, list[Row]]]:
        """Give the rows of each jury to change, and write them."""
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
                said = str(row[name])
                if not (said.isascii() and said.isdecimal() and 0 < len(said) < 10):
                    raise RecordingError(f"{self.path}, line {line}: {name} {said!r} is no number")
        rows.sort(key=_place)
        return columns, {
            number: list(of) for number, of in groupby(rows, lambda row: _place(row)[0])
        }


def _place(row: Row) -> tuple[int, int]:
    return int(str(row["jury"])), int(str(row["order"]))


def _rows_of(juries: dict[int, list[Row]], number: int) -> list[Row]:
    if number not in juries:
        raise ParameterError(f"there is no jury {number}")
    return juries[number]


def _jury(path: Path, rows: Sequence[Row]) -> Jury:
    number = _place(rows[0])[0]
    said = [str(row["vote"] or "") for row in rows]
    voted = next((place for place, vote in enumerate(said) if not vote), len(said))
    wrong = next((vote for vote in said[:voted] if vote not in VOTES), None)
    if wrong is not None or any(said[voted:]):
        what = "a vote after one that is missing" if wrong is None else f"the vote {wrong!r}"
        raise RecordingError(
            f"{path}: jury {number} has {what}; votes are {', '.join(VOTES)}, from the first on"
        )
    listener, question, played = (str(rows[0][c] or "") for c in ("listener", "question", "played"))
    pairs = tuple((str(row["first"] or ""), str(row["second"] or "")) for row in rows)
    if any("" in pair or pair[0] == pair[1] for pair in pairs):
        raise RecordingError(f"{path}: jury {number} has a row without two different sounds")
    last_time = str(rows[voted - 1]["time"] or "") if voted else ""
    return Jury(number, listener, question, played, pairs, tuple(said[:voted]), last_time)

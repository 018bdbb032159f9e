"""Results that stay on disk after the call that they are kept for, and a look at them."""

from __future__ import annotations

import sqlite3
from contextlib import closing, contextmanager

from noise.batch.journal import Journal, journal_path


@contextmanager
def staying_results(target):
    """Give the results of earlier calls, which stay."""
    target.parent.mkdir(parents=True, exist_ok=True)
    with closing(Journal(journal_path(target), "same")) as journal:
        yield journal


def results_in(journal):
    """Number and key of each result in a journal, in the order in which they came."""
    if not journal.exists():
        return []
    try:
        with closing(sqlite3.connect(f"{journal.as_uri()}?mode=rw", uri=True)) as database:
            return database.execute("select rowid, key from result order by rowid").fetchall()
    except sqlite3.OperationalError:  # it is being made
        return []

"""Many recordings, one result each: in this process, in several, or on a cluster.

Whatever becomes of a process, nothing that was done is lost, nothing is done twice, and the table
is the same, byte for byte, as that of one process that nobody disturbed.
"""

from noise.batch.journal import (
    Journal,
    JournalReader,
    call_identity,
    journal_path,
    kept_results,
    open_journal,
    written_rows,
)
from noise.batch.work import (
    DIED,
    BatchRows,
    Done,
    Job,
    Work,
    file_identity,
    find_jobs,
    one_thread,
    perform_all,
)

__all__ = [
    "DIED",
    "BatchRows",
    "Done",
    "Job",
    "Journal",
    "JournalReader",
    "Work",
    "call_identity",
    "file_identity",
    "find_jobs",
    "journal_path",
    "kept_results",
    "one_thread",
    "open_journal",
    "perform_all",
    "written_rows",
]

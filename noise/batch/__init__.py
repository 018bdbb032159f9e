"""Many recordings, one result each: in this process, in several, or on a cluster.

Whatever becomes of a process, nothing that was done is lost, nothing is done twice, and the table
is the same, byte for byte, as that of one process that nobody disturbed.
"""

from noise.batch.identity import file_digest, file_identity
from noise.batch.journal import Journal, JournalReader, open_journal
from noise.batch.lines import journal_path
from noise.batch.work import Done, Job, Work, find_jobs, perform_all

__all__ = [
    "Done",
    "Job",
    "Journal",
    "JournalReader",
    "Work",
    "file_digest",
    "file_identity",
    "find_jobs",
    "journal_path",
    "open_journal",
    "perform_all",
]

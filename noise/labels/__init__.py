"""Labels in time, and the table that links them to operating conditions."""

from noise.labels.segments import Segment, Segments, file_label, label_recording
from noise.labels.table import COLUMNS, LabelTable, error_row, label_rows

__all__ = [
    "COLUMNS",
    "LabelTable",
    "Segment",
    "Segments",
    "error_row",
    "file_label",
    "label_recording",
    "label_rows",
]

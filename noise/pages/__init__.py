"""Pages to look at and listen to."""

from noise.pages.diagnosis.page import write_diagnosis
from noise.pages.report import ReportEntry, write_report

__all__ = ["ReportEntry", "write_diagnosis", "write_report"]

"""Pages to look at and listen to."""

from noise.report.diagnosis_page import write_diagnosis
from noise.report.page import ReportEntry, write_report

__all__ = ["ReportEntry", "write_diagnosis", "write_report"]

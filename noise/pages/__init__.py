"""Pages to look at and listen to."""

from noise.pages.demo.page import ReportEntry, write_report
from noise.pages.diagnosis.page import write_diagnosis

__all__ = ["ReportEntry", "write_diagnosis", "write_report"]

"""Pages to look at and listen to."""

from noise.report.page import ReportEntry, write_report

__all__ = ["ReportEntry", "write_report"]

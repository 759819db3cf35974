"""The report of a log: one self-contained HTML page, and its facts as values for JSON."""

from __future__ import annotations

from mavstack.logs.report.report import Report, make_report

__all__ = ["Report", "make_report"]

"""Export of logs to other formats: Parquet, Arrow, CSV, MCAP, MAT, tlog, KML, GPX, GeoJSON."""

from __future__ import annotations

from mavstack.logs.export.exporting import ExportSummary, export_log
from mavstack.logs.export.registry import LogExporter, exporter, exporter_names
from mavstack.logs.export.writer import ExportOptions, ExportWriter

__all__ = [
    "ExportOptions",
    "ExportSummary",
    "ExportWriter",
    "LogExporter",
    "export_log",
    "exporter",
    "exporter_names",
]

"""The flight book: the flights of a folder of logs, in one DuckDB file."""

from __future__ import annotations

from mavstack.logs.book.book import COLUMNS, BookUpdate, FlightBook

__all__ = ["COLUMNS", "BookUpdate", "FlightBook"]

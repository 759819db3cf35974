"""Log files: indexing, and decoding to columns of numpy arrays."""

from __future__ import annotations

from mavstack.logs.packet_log import LogFile, open_log
from mavstack.logs.tables import HEADER_COLUMNS, table_dtype

__all__ = ["HEADER_COLUMNS", "LogFile", "open_log", "table_dtype"]

"""Log files: indexing, and decoding to columns of numpy arrays."""

from __future__ import annotations

from mavstack.logs.message_table import MessageTable
from mavstack.logs.packet_log import LogFile, open_log
from mavstack.logs.tables import HEADER_COLUMNS, table_dtype

__all__ = ["HEADER_COLUMNS", "LogFile", "MessageTable", "open_log", "table_dtype"]

"""Log files of any format: indexing, and decoding to columns of numpy arrays."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from mavstack.logs.damage import LogDamage
from mavstack.logs.log import Log
from mavstack.logs.merge import merge_logs
from mavstack.logs.merged_log import MergedLog
from mavstack.logs.merged_source import LogOffset
from mavstack.logs.message_table import MessageTable
from mavstack.logs.opening import open_log
from mavstack.logs.records import LogRecord, LogText, ParameterChange
from mavstack.logs.registry import LogFormat
from mavstack.logs.schema import EnumSchema, FieldSchema, TableSchema
from mavstack.logs.time_base import TimeBase
from mavstack.logs.vehicles import LogVehicle

if TYPE_CHECKING:
    from mavstack.logs.packets import HEADER_COLUMNS, PacketLog, table_dtype

__all__ = [
    "HEADER_COLUMNS",
    "EnumSchema",
    "FieldSchema",
    "Log",
    "LogDamage",
    "LogFormat",
    "LogOffset",
    "LogRecord",
    "LogText",
    "LogVehicle",
    "MergedLog",
    "MessageTable",
    "PacketLog",
    "ParameterChange",
    "TableSchema",
    "TimeBase",
    "merge_logs",
    "open_log",
    "table_dtype",
]


def __getattr__(name: str) -> Any:  # noqa: ANN401 (any of the names of packet logs)
    # Import the packet reader only when it is used, because other formats do not need it.
    if name not in {"HEADER_COLUMNS", "PacketLog", "table_dtype"}:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from mavstack.logs import packets

    return getattr(packets, name)

"""Logs of packets: tlogs and raw streams."""

from __future__ import annotations

from mavstack.logs.packets.packet_log import PacketLog
from mavstack.logs.packets.tables import HEADER_COLUMNS, table_dtype

__all__ = ["HEADER_COLUMNS", "PacketLog", "table_dtype"]

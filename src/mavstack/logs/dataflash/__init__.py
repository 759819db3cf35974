"""ArduPilot's onboard logs: binary (`.BIN`) and as text (`.log`)."""

from __future__ import annotations

from mavstack.logs.dataflash.dataflash_log import DataFlashLog
from mavstack.logs.dataflash.text_log import DataFlashTextLog

__all__ = ["DataFlashLog", "DataFlashTextLog"]

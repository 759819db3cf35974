"""PX4's onboard logs (.ulg)."""

from __future__ import annotations

from mavstack.logs.ulog.entries import Dropout, LoggedText
from mavstack.logs.ulog.ulog import ULog

__all__ = ["Dropout", "LoggedText", "ULog"]

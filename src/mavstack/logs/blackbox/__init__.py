"""Blackbox logs of Betaflight, Cleanflight, INAV and their relatives (`.bbl`, `.bfl`, `.TXT`)."""

from __future__ import annotations

from mavstack.logs.blackbox.blackbox_log import BlackboxLog

__all__ = ["BlackboxLog"]

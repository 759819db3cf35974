"""Refusing a command from wherever the reason is found."""

from __future__ import annotations

from mavstack.dialects import common
from mavstack.errors import MavstackError


class CommandRefusedError(MavstackError):
    """Ends a handler: its answer, and what is said beside it, "" if nothing."""

    def __init__(self, result: int = common.MavResult.FAILED, text: str = "") -> None:
        super().__init__(text or f"refused with MAV_RESULT {int(result)}")
        self.result = common.MavResult(result)
        self.text = text

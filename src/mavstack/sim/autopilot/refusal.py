"""The refusal of a command, raised anywhere below its handler."""

from __future__ import annotations

from mavstack.dialects import common
from mavstack.errors import MavstackError


class CommandRefusedError(MavstackError):
    """Ends a handler with a result, and a status text unless it is empty."""

    def __init__(self, result: int = common.MavResult.FAILED, text: str = "") -> None:
        super().__init__(text or f"refused with MAV_RESULT {int(result)}")
        self.result = common.MavResult(result)
        self.text = text

"""The refusal of a command, raised by its handler or by a function that the handler calls."""

from __future__ import annotations

from mavstack.dialects import common
from mavstack.errors import MavstackError


class CommandRefusedError(MavstackError):
    """Raised to answer a command with a result, and with a status text unless it is empty."""

    def __init__(self, result: int = common.MavResult.FAILED, text: str = "") -> None:
        super().__init__(text or f"refused with MAV_RESULT {int(result)}")
        self.result = common.MavResult(result)
        self.text = text

"""The procedure of a calibration: the functions that run it and that cancel it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable, Coroutine
    from typing import Any

    from mavstack.vehicle.calibration.conversation import Conversation
    from mavstack.vehicle.vehicle import Vehicle


@dataclass(frozen=True, slots=True)
class Procedure:
    """The procedure of one calibration with one firmware.

    Attributes:
        run: Holds the conversation to its end.
        cancel: Tells the vehicle to cancel the calibration.
        needs_confirmation: True if steps of it wait for the program's confirmation.
        can_cancel: False if the vehicle cannot cancel it: it ends by itself, or waits for its next start.
    """

    run: Callable[[Conversation], Awaitable[None]]
    cancel: Callable[[Vehicle], Coroutine[Any, Any, None]]
    needs_confirmation: bool = False
    can_cancel: bool = True

"""The events that a PX4 vehicle sends during an operation, attached to the operation's error.

PX4 gives the reasons of a refusal as events (EVENT), and only some of them as status texts too. The words are
in the vehicle's metadata: those that are known are used, and nothing is downloaded for an error.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.services.events import LogLevel

if TYPE_CHECKING:
    from mavstack.node.component import RemoteComponent
    from mavstack.node.events import EventStream
    from mavstack.services.events import DecodedEvent

#: The largest number of events in an error.
MAX_EVENTS: Final = 6
#: The size of the event queue: larger than `MAX_EVENTS`, because less severe events are left out when they
#: are read.
_QUEUE: Final = 64


class EventCapture:
    """Collects the events of a component while an operation runs; other firmwares than PX4 send none.

    Args:
        component: The autopilot.
    """

    def __init__(self, component: RemoteComponent) -> None:
        info = component.info
        self._stream: EventStream | None = None
        if info is not None and info.autopilot == common.MavAutopilot.PX4:
            self._stream = component.events(severity=LogLevel.WARNING, queue=_QUEUE)

    def take(self) -> tuple[str, ...]:
        """Return the messages of the last events of severity WARNING and above, each once, oldest first."""
        found: list[DecodedEvent] = [] if self._stream is None else self._stream.drain()
        return tuple(dict.fromkeys(event.message for event in found))[-MAX_EVENTS:]

    def close(self) -> None:
        """Stop collecting. Idempotent."""
        if self._stream is not None:
            self._stream.close()

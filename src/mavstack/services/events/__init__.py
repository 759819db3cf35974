"""Events: notices of a component, delivered reliably and in order (guide: events interface).

A component numbers its events, broadcasts each once (EVENT), and states the newest number every three seconds
(CURRENT_EVENT_SEQUENCE). A receiver that misses numbers requests them (REQUEST_EVENT); the sender repeats the
events that it still keeps, and names the oldest one for those that it does not (RESPONSE_EVENT_ERROR).

On the wire an event has an id, two log levels and up to 40 bytes of arguments. Its name, its message and the
types of its arguments are in the component metadata of type EVENTS (`definitions`).
"""

from mavstack.services.events.decoded import DecodedEvent, decode_event
from mavstack.services.events.definitions import (
    EventArgument,
    EventContent,
    EventDefinition,
    EventEnum,
    decode_content,
    parse_event_metadata,
)
from mavstack.services.events.receiver import EventReceived, EventReceiver, EventsLost
from mavstack.services.events.sender import EventSender, LogLevel

__all__ = [
    "DecodedEvent",
    "EventArgument",
    "EventContent",
    "EventDefinition",
    "EventEnum",
    "EventReceived",
    "EventReceiver",
    "EventSender",
    "EventsLost",
    "LogLevel",
    "decode_content",
    "decode_event",
    "parse_event_metadata",
]

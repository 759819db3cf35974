from __future__ import annotations

from dataclasses import replace

from mavstack.services.events import EventReceived, LogLevel, decode_event, parse_event_metadata
from tests.services.events.test_definitions import document
from tests.services.network import VEHICLE

TABLE = parse_event_metadata(document())
EVENT = EventReceived(VEHICLE, 7, 0x01000005, 2500, 2, 6, b"\x01" + bytes(39), time=1000.0)


def test_an_event_is_decoded_with_its_words():
    event = decode_event(EVENT, TABLE)
    assert str(event) == event.message == "Stopped: too hot at 0.0 m"
    assert (event.name, event.group, event.is_known) == ("sample::stopped", "default", True)
    assert event.arguments == {"cause": "hot", "height": 0.0}
    assert (event.severity, event.internal_severity) == (LogLevel.CRITICAL, LogLevel.INFO)
    assert (event.source, event.sequence, event.time, event.time_boot) == (VEHICLE, 7, 1000.0, 2.5)
    assert hash(event) == hash(replace(event))


def test_an_event_without_metadata_is_named_by_its_id():
    event = decode_event(replace(EVENT, id=0x01ABCDEF, level=12), TABLE)
    assert str(event) == "event 0x01abcdef (no metadata)"
    assert (event.name, event.is_known, event.severity, event.arguments) == ("", False, 12, {})
    assert event.data == EVENT.arguments

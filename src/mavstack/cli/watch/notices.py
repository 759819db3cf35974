"""The last notices of a link: status texts, and events with the words of cached metadata.

`mav watch` requests nothing, so it knows the events whose metadata the user's cache has from earlier
connections to vehicles with that firmware. PX4 sends most events as status texts too, marked by a tab: a text
is left out for each event that is shown.
"""

from __future__ import annotations

from collections import Counter
from functools import cached_property
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.field_values import field_texts
from mavstack.dialects import common
from mavstack.errors import MetadataError
from mavstack.files.parameter_metadata import MetadataCache
from mavstack.services.events import LogLevel, decode_content, parse_event_metadata
from mavstack.services.statustext import EVENT_MARK

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from mavstack.services.events import EventDefinition
    from mavstack.wire import Packet

#: Maximum number of notices that are shown.
MAX_NOTICES: Final = 4
#: Number of cached metadata files that are read: the newest ones.
_MAX_FILES: Final = 4
_LEVEL_BITS: Final = 0xF


def is_notice(packet: Packet) -> bool:
    """Return whether a packet holds a status text, or an event that is not only for programs."""
    match packet.message:
        case common.Statustext():
            return True
        case common.Event(log_levels=levels):
            return levels & _LEVEL_BITS <= LogLevel.DEBUG
    return False


class Notices:
    """The texts of status texts and events."""

    @cached_property
    def _definitions(self) -> dict[int, EventDefinition]:
        """The definitions of the cached files, read when the first event is shown."""
        found: dict[int, EventDefinition] = {}
        for data in reversed(MetadataCache().newest(common.CompMetadataType.EVENTS, _MAX_FILES)):
            try:
                found.update(parse_event_metadata(data))
            except MetadataError:
                continue
        return found

    def texts(self, packets: Iterable[Packet]) -> list[str]:
        """Return the notices of STATUSTEXT and EVENT packets, oldest first."""
        found = list(self._parts(packets))
        shown_events = Counter(source for source, text, kind in found if kind == "event")
        texts = []
        for source, text, kind in reversed(found):
            if kind == "marked" and shown_events[source]:
                shown_events[source] -= 1
            else:
                texts.append(text)
        return texts[:MAX_NOTICES][::-1]

    def _parts(self, packets: Iterable[Packet]) -> Iterator[tuple[str, str, str]]:
        """Yield source, text and kind of each notice: event, marked (as one that has an event), or text."""
        for packet in packets:
            source = f"{packet.system}/{packet.component}"
            match packet.message:
                case common.Statustext(text=text) as message:
                    severity = {value.name: value.text for value in field_texts(message)}["severity"]
                    kind = "marked" if text.endswith(EVENT_MARK) else "text"
                    yield source, f"{source} {severity}: {text.rstrip()}", kind
                case common.Event(log_levels=levels) as event:
                    level, definition = LogLevel(levels & _LEVEL_BITS), self._definitions.get(event.id)
                    if definition is not None:
                        content = decode_content(definition, bytes(event.arguments))
                        yield source, f"{source} {level.name}: {content.message}", "event"

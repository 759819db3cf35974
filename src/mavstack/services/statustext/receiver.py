"""The receiver of status texts, which assembles chunks.

Chunks belong together if system, component and id are equal. A text is emitted when all its chunks have
arrived, in any order, or after a timeout with its missing chunks marked. A chunk that contradicts one of the
same number belongs to a new text, because ids restart when the sender reboots (which takes longer than the
timeout). Duplicates are emitted once.

PX4 ends a text by a tab if it sends the same notice as an EVENT too; the tab becomes `has_event`.
"""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

from mavstack.dialects import common
from mavstack.services.addressing import Address, message_ids
from mavstack.services.service import Event, Service
from mavstack.services.statustext.chunks import CHUNK
from mavstack.services.timing import DUPLICATE_WINDOW

if TYPE_CHECKING:
    from mavstack.wire import Packet

#: The text that replaces missing chunks.
GAP = "[...]"
#: Seconds to wait for missing chunks after the last chunk that arrived.
CHUNK_TIMEOUT = 2.0
#: Seconds for which chunks of an emitted text are recognised as duplicates.
DUPLICATE_CHUNK_WINDOW = 5.0
#: The end of a text that the sender also sends as an EVENT.
EVENT_MARK = "\t"
MAX_TEXTS = 64
MAX_REMEMBERED = 256


@dataclass(frozen=True, slots=True)
class StatusText(Event):
    """A status text of a component.

    Attributes:
        source: The component that sent it.
        severity: Its MAV_SEVERITY.
        text: The text; `GAP` marks lost chunks.
        complete: False if chunks were lost.
        has_event: True if the component sends an EVENT too, as PX4 marks it.
    """

    source: Address
    severity: int
    text: str
    complete: bool = True
    has_event: bool = False


class _Key(NamedTuple):
    source: Address
    number: int


@dataclass(slots=True)
class _Text:
    """The chunks of one text."""

    severity: int
    due: float
    chunks: dict[int, bytes] = field(default_factory=dict)

    def contradicts(self, severity: int, index: int, chunk: bytes) -> bool:
        if severity != self.severity or self.chunks.get(index, chunk) != chunk:
            return True
        last = self.last
        if last is not None:
            return index > last or (len(chunk) < CHUNK and index != last)
        return len(chunk) < CHUNK and any(known > index for known in self.chunks)

    @property
    def last(self) -> int | None:
        return next((index for index, chunk in self.chunks.items() if len(chunk) < CHUNK), None)

    @property
    def complete(self) -> bool:
        last = self.last
        return last is not None and len(self.chunks) == last + 1

    def joined(self) -> str:
        """Return the text with its missing chunks marked."""
        runs: list[bytes] = []
        previous = -1
        for index in sorted(self.chunks):
            if index == previous + 1 and runs:
                runs[-1] += self.chunks[index]
            else:
                runs += [b""] * (index > 0 and not runs) + [self.chunks[index]]
            previous = index
        text = GAP.join(run.decode("utf-8", "replace") for run in runs)
        return text if self.last is not None else text + GAP


class StatustextReceiver(Service):
    """The receiver that emits the texts of all components as `StatusText` events."""

    handles = message_ids(common.Statustext)

    def __init__(self, local: Address) -> None:
        super().__init__(local)
        self._open: OrderedDict[_Key, _Text] = OrderedDict()
        self._emitted: OrderedDict[_Key, _Text] = OrderedDict()
        self._singles: OrderedDict[tuple[Address, int, bytes], float] = OrderedDict()

    def receive(self, packet: Packet, now: float) -> None:
        match packet.message:
            case common.Statustext(id=number, chunk_seq=index, severity=severity):
                source = Address(packet.system, packet.component)
                # The bytes are used instead of `message.text`, because a character may be split between two
                # chunks.
                chunk = packet.payload[1 : 1 + CHUNK].partition(b"\0")[0]
                if number == 0:
                    self._single(source, packet, int(severity), chunk, now)
                else:
                    self._chunk(_Key(source, number), int(severity), index, chunk, now)

    def next_timeout(self) -> float | None:
        return min((text.due for text in self._open.values()), default=None)

    def handle_timeout(self, now: float) -> None:
        for key in [key for key, text in self._open.items() if now >= text.due]:
            self._close(key, now)

    def _single(self, source: Address, packet: Packet, severity: int, chunk: bytes, now: float) -> None:
        key = source, packet.sequence, packet.payload
        before = self._singles.pop(key, None)
        self._singles[key] = now
        if len(self._singles) > MAX_REMEMBERED:
            self._singles.popitem(last=False)
        if before is None or now - before > DUPLICATE_WINDOW:
            self._emit(source, severity, chunk.decode("utf-8", "replace"))

    def _chunk(self, key: _Key, severity: int, index: int, chunk: bytes, now: float) -> None:
        text = self._open.get(key)
        if text is None or text.contradicts(severity, index, chunk):
            if self._is_copy(key, severity, index, chunk, now):
                return
            if text is not None:
                self._close(key, now)
            text = None
        if text is None:
            text = self._open[key] = _Text(severity, now)
        text.chunks[index] = chunk
        text.due = now + CHUNK_TIMEOUT
        if text.complete:
            self._close(key, now)
        elif len(self._open) > MAX_TEXTS:
            self._close(next(iter(self._open)), now)

    def _emit(self, source: Address, severity: int, text: str, complete: bool = True) -> None:
        has_event = text.endswith(EVENT_MARK)
        self.emit(StatusText(source, severity, text.removesuffix(EVENT_MARK), complete, has_event))

    def _is_copy(self, key: _Key, severity: int, index: int, chunk: bytes, now: float) -> bool:
        emitted = self._emitted.get(key)
        if emitted is None or now > emitted.due:
            return False
        if key in self._open:  # a text with the same id is open, because the sender restarted its ids
            return emitted.chunks.get(index) == chunk
        # A missing chunk that arrives after its text was emitted does not become a text itself.
        return not emitted.contradicts(severity, index, chunk)

    def _close(self, key: _Key, now: float) -> None:
        text = self._open.pop(key)
        self._emit(key.source, text.severity, text.joined(), text.complete)
        text.due = now + DUPLICATE_CHUNK_WINDOW
        self._emitted[key] = text
        self._emitted.move_to_end(key)
        if len(self._emitted) > MAX_REMEMBERED:
            self._emitted.popitem(last=False)

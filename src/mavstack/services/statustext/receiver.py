"""Putting texts together from what was heard: the ground's side of STATUSTEXT.

Chunks belong together if system, component and id are the same. A text is told when all its chunks are
there, in whatever order they came, and at the latest when nothing came for a while: then what is missing is
marked in it. A chunk that contradicts one of the same number belongs to a new text, because ids begin anew
when the sender does (which takes it longer than a text waits here). What came twice is told once.
"""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

from mavstack.dialects import common
from mavstack.services.addressing import Address, message_ids
from mavstack.services.service import Event, Service
from mavstack.services.statustext.chunks import CHUNK
from mavstack.services.timing import DOUBLED_WITHIN

if TYPE_CHECKING:
    from mavstack.wire import Packet

#: What stands for missing chunks.
GAP = "[...]"
#: How long a text waits for its missing chunks after the last one that came, in seconds.
CHUNK_TIMEOUT = 2.0
#: For so long a chunk of a text already told is known as a copy.
MEMORY = 5.0
MOST_TEXTS = 64
MOST_REMEMBERED = 256


@dataclass(frozen=True, slots=True)
class StatusText(Event):
    """A component told something; `complete` is False if parts of it were lost, `GAP` stands for them."""

    source: Address
    severity: int
    text: str
    complete: bool = True


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
        """The text with its gaps marked."""
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
    """Tells the texts of everybody as `StatusText` events."""

    handles = message_ids(common.Statustext)

    def __init__(self, local: Address) -> None:
        super().__init__(local)
        self._open: OrderedDict[_Key, _Text] = OrderedDict()
        self._told: OrderedDict[_Key, _Text] = OrderedDict()
        self._singles: OrderedDict[tuple[Address, int, bytes], float] = OrderedDict()

    def receive(self, packet: Packet, now: float) -> None:
        match packet.message:
            case common.Statustext(id=number, chunk_seq=index, severity=severity):
                source = Address(packet.system, packet.component)
                # Not `message.text`: a character may be cut in two.
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
        if len(self._singles) > MOST_REMEMBERED:
            self._singles.popitem(last=False)
        if before is None or now - before > DOUBLED_WITHIN:
            self.emit(StatusText(source, severity, chunk.decode("utf-8", "replace")))

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
        elif len(self._open) > MOST_TEXTS:
            self._close(next(iter(self._open)), now)

    def _is_copy(self, key: _Key, severity: int, index: int, chunk: bytes, now: float) -> bool:
        told = self._told.get(key)
        if told is None or now > told.due:
            return False
        if key in self._open:  # by a sender that began its ids anew
            return told.chunks.get(index) == chunk
        # What a text that was told with a gap still lacks comes too late; it is no text of its own.
        return not told.contradicts(severity, index, chunk)

    def _close(self, key: _Key, now: float) -> None:
        text = self._open.pop(key)
        self.emit(StatusText(key.source, text.severity, text.joined(), text.complete))
        text.due = now + MEMORY
        self._told[key] = text
        self._told.move_to_end(key)
        if len(self._told) > MOST_REMEMBERED:
            self._told.popitem(last=False)

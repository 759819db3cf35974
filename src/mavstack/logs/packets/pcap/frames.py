"""The frames in a capture: pcap and pcapng, either byte order, times in any resolution.

A pcap file is a header and then records of a time, two lengths and a frame. A pcapng file is a sequence of
blocks, whose length stands at both ends; a section block sets the byte order, and an interface block the link
type and the resolution of the times. After damage the next place is searched where the lengths are sound
again.

Sources: draft-ietf-opsawg-pcap, draft-ietf-opsawg-pcapng.
"""

from __future__ import annotations

from dataclasses import dataclass
from struct import Struct, error, unpack_from
from typing import TYPE_CHECKING, Final, NamedTuple, TypeAlias

if TYPE_CHECKING:
    import mmap
    from collections.abc import Iterator

#: The bytes of a file.
Content: TypeAlias = "bytes | mmap.mmap"
_PCAP_HEADER, _RECORD_HEADER, _BLOCK_ENDS = 24, 16, 12
#: Byte order and time units per second, by magic number.
_PCAP_MAGICS: Final = {
    b"\xd4\xc3\xb2\xa1": ("<", 10**6),
    b"\xa1\xb2\xc3\xd4": (">", 10**6),
    b"\x4d\x3c\xb2\xa1": ("<", 10**9),
    b"\xa1\xb2\x3c\x4d": (">", 10**9),
}
_SECTION_MAGICS: Final = {b"\x4d\x3c\x2b\x1a": "<", b"\x1a\x2b\x3c\x4d": ">"}
_SECTION, _INTERFACE, _OLD_PACKET, _SIMPLE, _ENHANCED = 0x0A0D0D0A, 1, 2, 3, 6
#: Known block types: packets, and also names, statistics, secrets and custom blocks.
_KNOWN_BLOCKS: Final = frozenset(
    {_SECTION, _INTERFACE, _OLD_PACKET, _SIMPLE, 4, 5, _ENHANCED, 10, 0xBAD, 0x4000_0BAD}
)
_RESOLUTION, _OFFSET = 9, 14
#: Size in bytes of the largest frame that capture programs record.
_MAX_FRAME: Final = 1 << 18
_MAX_BLOCK: Final = 1 << 24
#: Seconds between two records beyond which damage is assumed.
_MAX_PAUSE: Final = 30 * 86_400
_LINK_TYPE_MASK: Final = 0x0FFF_FFFF
_MICROSECONDS: Final = 10**6


class Frame(NamedTuple):
    """A frame: its time in microseconds since 1970 (None if it is not recorded), link type and bytes."""

    time: int | None
    link_type: int
    data: bytes


@dataclass(slots=True)
class CaptureDamage:
    """Counts of the parts of a capture that were not read.

    Attributes:
        bad_bytes: Bytes that are no record.
        truncated_bytes: Bytes of a record that the end of the file cuts off.
    """

    bad_bytes: int = 0
    truncated_bytes: int = 0


@dataclass(frozen=True, slots=True)
class _Interface:
    link_type: int
    units: int = _MICROSECONDS
    offset: int = 0


def read_frames(data: Content, damage: CaptureDamage) -> Iterator[Frame]:
    """Yield the frames of a capture.

    Args:
        data: The bytes of the file.
        damage: Counts, which are increased.
    """
    found = _PCAP_MAGICS.get(bytes(data[:4]))
    if found is None:
        yield from _read_blocks(data, damage)
    elif len(data) < _PCAP_HEADER:
        damage.truncated_bytes += len(data)
    else:
        order, units = found
        (link_type,) = unpack_from(f"{order}I", data, 20)
        yield from _read_records(data, Struct(f"{order}4I"), units, link_type & _LINK_TYPE_MASK, damage)


def _read_records(
    data: Content, head: Struct, units: int, link_type: int, damage: CaptureDamage
) -> Iterator[Frame]:
    records = _Records(data, head, units)
    position = _PCAP_HEADER
    while position < len(data):
        end = records.end_of(position)
        if end is not None and end <= len(data) and records.is_plausible(position, end):
            seconds, fraction, _, _ = head.unpack_from(data, position)
            records.last = seconds
            time = seconds * _MICROSECONDS + fraction * _MICROSECONDS // units
            yield Frame(time, link_type, data[position + _RECORD_HEADER : end])
            position = end
        elif position + _RECORD_HEADER > len(data) or (end is not None and end > len(data)):
            damage.truncated_bytes += len(data) - position
            return
        else:
            start, position = position, records.find(position + 1)
            damage.bad_bytes += position - start


@dataclass(slots=True)
class _Records:
    """The records of a pcap file, and the time of the last sound one in seconds."""

    data: Content
    head: Struct
    units: int
    last: int | None = None

    def end_of(self, position: int) -> int | None:
        """Return the end of a record with sound lengths and time."""
        if position + _RECORD_HEADER > len(self.data):
            return None
        _, fraction, length, original = self.head.unpack_from(self.data, position)
        sound = fraction < self.units and length <= original <= _MAX_FRAME
        return position + _RECORD_HEADER + length if sound else None

    def is_plausible(self, position: int, end: int) -> bool:
        """Return whether a record is near the last one in time, or another follows: clocks are set."""
        return self._is_near(position) or (end > position + _RECORD_HEADER and self._continues(end))

    def find(self, position: int) -> int:
        """Return the next position of a record that another record or the end of the file follows."""
        while position < len(self.data):
            end = self.end_of(position)
            if end is not None and self._is_near(position) and self._continues(end):
                return position
            position += 1
        return len(self.data)

    def _is_near(self, position: int) -> bool:
        seconds: int = self.head.unpack_from(self.data, position)[0]
        return self.last is None or abs(seconds - self.last) < _MAX_PAUSE

    def _continues(self, end: int) -> bool:
        return end == len(self.data) or (end < len(self.data) and self.end_of(end) is not None)


def _read_blocks(data: Content, damage: CaptureDamage) -> Iterator[Frame]:
    position, order = 0, "<"
    interfaces: list[_Interface] = []
    while position < len(data):
        order = _order_of(data, position) or order
        end = _block_end(data, position, order)
        if end is None:
            start, position = position, _next_block(data, position + 1, order)
            if position == len(data) and _is_cut_off(data, start, order):
                damage.truncated_bytes += position - start
            else:
                damage.bad_bytes += position - start
            continue
        (kind,) = unpack_from(f"{order}I", data, position)
        body = data[position + 8 : end - 4]
        try:
            if kind == _SECTION:
                interfaces = []
            elif kind == _INTERFACE:
                interfaces.append(_interface(body, order))
            elif (frame := _frame(kind, body, order, interfaces)) is not None:
                yield frame
        except (error, IndexError):
            damage.bad_bytes += end - position
        position = end


def _order_of(data: Content, position: int) -> str | None:
    """Return the byte order that a section block sets; its kind reads the same in both."""
    if data[position : position + 4] != b"\x0a\x0d\x0d\x0a":
        return None
    return _SECTION_MAGICS.get(bytes(data[position + 8 : position + 12]))


def _block_end(data: Content, position: int, order: str) -> int | None:
    """Return the end of a sound block."""
    if position + _BLOCK_ENDS > len(data):
        return None
    _, length = unpack_from(f"{order}2I", data, position)
    end: int = position + length
    if length < _BLOCK_ENDS or length % 4 or length > _MAX_BLOCK or end > len(data):
        return None
    return end if unpack_from(f"{order}I", data, end - 4) == (length,) else None


def _next_block(data: Content, position: int, order: str) -> int:
    while position + _BLOCK_ENDS <= len(data):
        if unpack_from(f"{order}I", data, position)[0] in _KNOWN_BLOCKS and _block_end(data, position, order):
            return position
        position += 1
    return len(data)


def _is_cut_off(data: Content, position: int, order: str) -> bool:
    if position + 8 > len(data):
        return True
    kind, length = unpack_from(f"{order}2I", data, position)
    return kind in _KNOWN_BLOCKS and _BLOCK_ENDS <= length <= _MAX_BLOCK and position + length > len(data)


def _interface(body: bytes, order: str) -> _Interface:
    (link_type,) = unpack_from(f"{order}H", body)
    units, offset, position = _MICROSECONDS, 0, 8
    while position + 4 <= len(body):
        code, length = unpack_from(f"{order}2H", body, position)
        value = body[position + 4 : position + 4 + length]
        if code == _RESOLUTION and length == 1:
            units = 2 ** (value[0] & 0x7F) if value[0] & 0x80 else 10 ** value[0]
        elif code == _OFFSET and length == 8:
            (offset,) = unpack_from(f"{order}q", value)
        position += 4 + (length + 3 & ~3)
    return _Interface(link_type, units, offset)


def _frame(kind: int, body: bytes, order: str, interfaces: list[_Interface]) -> Frame | None:
    if kind == _ENHANCED:
        number, high, low, length, _ = unpack_from(f"{order}5I", body)
    elif kind == _OLD_PACKET:
        number, _, high, low, length, _ = unpack_from(f"{order}2H4I", body)
    elif kind == _SIMPLE:
        (length,) = unpack_from(f"{order}I", body)
        return Frame(None, interfaces[0].link_type, body[4 : 4 + length])
    else:
        return None
    interface = interfaces[number]
    time = interface.offset * _MICROSECONDS + ((high << 32) | low) * _MICROSECONDS // interface.units
    return Frame(time, interface.link_type, body[20 : 20 + length])

"""Decoders of frames, declared as data: how a stream of bytes is cut into frames, and which values they hold.

    {"type": "mavstack-decoder", "version": 1, "name": "bench", "endian": "little",
     "framing": {"kind": "length", "marker": "aa55", "length": {"offset": 2, "type": "uint8"}, "add": 5},
     "checksum": {"kind": "crc16-ccitt", "start": 2},
     "id": {"offset": 3, "type": "uint8"},
     "messages": [
       {"name": "IMU", "id": 1, "fields": [
         {"name": "roll", "type": "int16", "factor": 0.01, "unit": "deg"},
         {"name": "mode", "type": "uint8", "names": {"0": "IDLE", "1": "FLYING"}}]}]}

A decoder without messages finds frames and leaves their bytes to a script. The pages of the station read the
same declarations (`web/src/lib/frames/decoder.ts`); `web/src/lib/frames/decoder-cases.json` tests both.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Literal, cast

from mavstack.server.rows.checksums import CHECKSUMS
from mavstack.server.rows.frame_fields import (
    INTEGERS,
    NUMBERS,
    TEXT,
    FrameField,
    NumberPlace,
    NumberType,
)
from mavstack.server.rows.framing import MAX_DATAGRAM, MAX_FRAME, make_framer
from mavstack.server.rows.members import Members, refuse
from mavstack.server.rows.template import Row

if TYPE_CHECKING:
    from mavstack.server.rows.frame_fields import Endian, Value

FILE_TYPE: Final = "mavstack-decoder"
FILE_VERSION: Final = 1
#: Message name of frames that match no declared message, and of a declared message without a name.
FRAME_MESSAGE: Final = "FRAME"
DEFAULT_MESSAGE: Final = "ROW"
MAX_MESSAGES: Final = 64
MAX_FIELDS: Final = 128
MAX_COUNT: Final = 256
_MAX_MARKER: Final = 16
_MAX_NAMES: Final = 256
_MAX_UNIT: Final = 16
_MAX_ADD: Final = 1 << 16
_ENDIANS: Final = ("little", "big")
_UNSIGNED: Final = tuple(name for name in INTEGERS if name.startswith("u") and name != "uint64")

Kind = Literal["datagram", "delimiter", "cobs", "fixed", "length"]
_KINDS: Final = ("datagram", "delimiter", "cobs", "fixed", "length")


@dataclass(frozen=True, slots=True)
class Framing:
    """How a stream is cut.

    Attributes:
        kind: The kind of framing.
        marker: The bytes that begin a frame, or the delimiter that ends it.
        size: The bytes of a frame of fixed size.
        length: The field with the length; None: there is none.
        add: Length plus this is the size of the frame, with its marker and checksum.
    """

    kind: Kind = "datagram"
    marker: bytes = b""
    size: int = 0
    length: NumberPlace | None = None
    add: int = 0

    @property
    def header(self) -> int:
        """The bytes up to the end of the marker and of the length."""
        if self.kind not in {"fixed", "length"}:
            return 0
        end = 0 if self.length is None else self.length.offset + self.length.type.size
        return max(len(self.marker), end)


@dataclass(frozen=True, slots=True)
class Checksum:
    """The checksum of a frame: its kind, its place, and the bytes that it covers."""

    kind: str
    place: NumberPlace
    start: int
    end: int | None

    def fits(self, frame: bytes) -> bool:
        """Return whether the checksum of a frame is right."""
        at = _index(self.place.offset, len(frame))
        end = at if self.end is None else _index(self.end, len(frame))
        if not (0 <= at <= len(frame) - self.place.type.size and 0 <= self.start <= end <= len(frame)):
            return False
        return CHECKSUMS[self.kind][1](frame[self.start : end]) == self.place.read(frame)


@dataclass(frozen=True, slots=True)
class FrameMessage:
    """A kind of frame: its number and its size, if they tell it from others, and its fields."""

    name: str
    id: int | None
    size: int | None
    fields: tuple[FrameField, ...]

    def read(self, frame: bytes, end: int) -> dict[str, Value] | None:
        """Return the values of a frame, whose checksum begins at `end`; None if the frame is too short."""
        if not all(each.is_inside(len(frame), end) for each in self.fields):
            return None
        values = {each.name: each.read(frame) for each in self.fields}
        return {name: value for name, value in values.items() if value is not None}


@dataclass(frozen=True, slots=True)
class FrameDecoder:
    """A decoder; see `parse_decoder`."""

    name: str
    framing: Framing
    checksum: Checksum | None
    id: NumberPlace | None
    messages: tuple[FrameMessage, ...]

    def read(self, frame: bytes) -> Row | None:
        """Return the row of a frame; None if no message fits."""
        if not self.messages:
            return frame_row(frame)
        number = self._number(frame)
        for message in self.messages:
            if message.id not in (None, number) or message.size not in (None, len(frame)):
                continue
            values = message.read(frame, _end(self.checksum, len(frame)))
            if values is not None:
                return Row(message.name, values)
        return None

    def _number(self, frame: bytes) -> int | None:
        if self.id is None:
            return None
        at = _index(self.id.offset, len(frame))
        return int(self.id.read(frame)) if 0 <= at <= len(frame) - self.id.type.size else None


class FrameReader:
    """Reads the rows of one stream.

    Args:
        decoder: The decoder; None: each chunk is a frame, whose bytes are left to scripts.
    """

    def __init__(self, decoder: FrameDecoder | None) -> None:
        self._decoder = decoder
        framing, checksum = (decoder.framing, decoder.checksum) if decoder else (Framing(), None)
        self._framer = make_framer(framing, checksum)
        self._unread = 0

    @property
    def refused(self) -> int:
        """Frames that were wrong or too long, and those that no message fits."""
        return self._framer.refused + self._unread

    def feed(self, data: bytes) -> list[Row]:
        """Return the rows that bytes complete."""
        frames = self._framer.feed(data)
        rows = [frame_row(each) if self._decoder is None else self._decoder.read(each) for each in frames]
        found = [row for row in rows if row is not None]
        self._unread += len(rows) - len(found)
        return found


def frame_row(frame: bytes) -> Row:
    """Return the row of a frame whose bytes a script reads."""
    return Row(FRAME_MESSAGE, {"size": float(len(frame))}, frame)


def parse_decoder(value: object) -> FrameDecoder:
    """Read the declaration of a decoder.

    Args:
        value: The object of the JSON file, as in the head of this module.

    Returns:
        The decoder.

    Raises:
        InvalidArgumentError: The declaration is malformed; the text names the place and the reason.
    """
    members = Members(value)
    members.choice("type", (FILE_TYPE,), FILE_TYPE)
    members.integer("version", FILE_VERSION, FILE_VERSION, FILE_VERSION)
    name = members.name("name", "decoder")
    endian = _endian(members, "little")
    framing = _framing(members.child("framing"), endian) if members.has("framing") else Framing()
    checksum = _checksum(members.child("checksum"), endian, framing) if members.has("checksum") else None
    number = _number_place(members.child("id"), endian, _UNSIGNED) if members.has("id") else None
    first = framing.header
    if number is not None and number.offset >= 0:
        first = max(first, number.offset + number.type.size)
    messages = tuple(
        _message(each, endian, first, (framing, checksum))
        for each in members.children("messages", MAX_MESSAGES)
    )
    members.end()
    _check_messages(messages, number)
    return FrameDecoder(name, framing, checksum, number, messages)


def _endian(members: Members, default: Endian) -> Endian:
    return cast("Endian", members.choice("endian", _ENDIANS, default))


def _framing(members: Members, endian: Endian) -> Framing:
    kind = cast("Kind", members.choice("kind", _KINDS))
    marker, size, length, add = b"\0" if kind == "cobs" else b"", 0, None, 0
    if kind == "delimiter":
        marker = members.hex_bytes("delimiter", 1, _MAX_MARKER)
    elif kind in {"fixed", "length"}:
        marker = members.hex_bytes("marker", 0, _MAX_MARKER, "")
    if kind == "fixed":
        size = members.integer("size", max(len(marker), 1), MAX_FRAME)
    elif kind == "length":
        length = _number_place(members.child("length"), endian, _UNSIGNED, minimum=0)
        add = members.integer("add", -_MAX_ADD, _MAX_ADD, 0)
    members.end()
    return Framing(kind, marker, size, length, add)


def _number_place(
    members: Members, endian: Endian, types: tuple[str, ...], *, minimum: int = -MAX_DATAGRAM
) -> NumberPlace:
    offset = members.integer("offset", minimum, MAX_DATAGRAM)
    kind = members.choice("type", types)
    place = NumberPlace(offset, NUMBERS[kind], _endian(members, endian))
    members.end()
    return place


def _checksum(members: Members, endian: Endian, framing: Framing) -> Checksum:
    kind = members.choice("kind", tuple(CHECKSUMS))
    size = CHECKSUMS[kind][0]
    offset = members.integer("offset", -MAX_DATAGRAM, MAX_DATAGRAM, -size)
    start = members.integer("start", 0, MAX_DATAGRAM, 0)
    end = members.integer("end", -MAX_DATAGRAM, MAX_DATAGRAM) if members.has("end") else None
    place = NumberPlace(offset, NumberType(size), _endian(members, endian))
    members.end()
    if framing.size and not 0 <= _index(offset, framing.size) <= framing.size - size:
        refuse(members.place_of("offset"), f"must be inside the {framing.size} bytes of a frame", offset)
    return Checksum(kind, place, start, end)


def _message(
    members: Members, endian: Endian, first: int, around: tuple[Framing, Checksum | None]
) -> FrameMessage:
    framing, checksum = around
    name = members.name("name", DEFAULT_MESSAGE)
    number = members.integer("id", 0, (1 << 32) - 1) if members.has("id") else None
    size = members.integer("size", 1, MAX_DATAGRAM) if members.has("size") else None
    length = size or framing.size
    fields: list[FrameField] = []
    offset = first
    for each in members.children("fields", MAX_FIELDS):
        found = _field(each, endian, offset)
        if any(other.name == found.name for other in fields):
            refuse(each.place_of("name"), "is the name of another field", found.name)
        if length and not found.is_inside(length, _end(checksum, length)):
            problem = f"must be inside the {length} bytes of a frame, before its checksum"
            refuse(each.place_of("offset"), problem, found.place.offset)
        fields.append(found)
        offset = found.place.offset + found.size
    members.end()
    if not fields:
        refuse(members.place_of("fields"), "must have at least one field")
    return FrameMessage(name, number, size, tuple(fields))


def _field(members: Members, endian: Endian, offset: int) -> FrameField:
    name = members.name("name")
    kind = members.choice("type", (*NUMBERS, TEXT))
    at = members.integer("offset", -MAX_DATAGRAM, MAX_DATAGRAM, offset)
    if kind == TEXT:
        size = members.integer("size", 1, MAX_FRAME)
        members.end()
        return FrameField(name, NumberPlace(at, NUMBERS["uint8"]), size, is_text=True)
    number = NUMBERS[kind]
    place = NumberPlace(at, number, _endian(members, endian))
    count = members.integer("count", 1, MAX_COUNT) if members.has("count") else 0
    factor, add = members.number("factor", 1.0), members.number("add", 0.0)
    unit = members.text("unit", _MAX_UNIT, "")
    bits = names = None
    if kind in INTEGERS and not count:
        bits = _bits(members.child("bits"), number.size * 8) if members.has("bits") else None
        names = members.texts("names", _MAX_NAMES)
    members.end()
    size = number.size * (count or 1)
    return FrameField(name, place, size, count, False, bits, factor, add, unit, names or {})


def _bits(members: Members, width: int) -> tuple[int, int]:
    first = members.integer("first", 0, width - 1)
    count = members.integer("count", 1, width - first)
    members.end()
    return first, count


def _check_messages(messages: tuple[FrameMessage, ...], number: NumberPlace | None) -> None:
    seen: set[tuple[int | None, int | None]] = set()
    for index, message in enumerate(messages):
        place = f"messages[{index}]"
        if message.id is not None and number is None:
            refuse(f"{place}.id", 'needs "id" in the decoder, which says where the number is')
        if any(message.name == other.name for other in messages[:index]):
            refuse(f"{place}.name", "is the name of another message", message.name)
        if (message.id, message.size) in seen:
            refuse(place, "has the id and the size of another message")
        seen.add((message.id, message.size))


def _end(checksum: Checksum | None, length: int) -> int:
    """Return the bytes before a checksum at the end of a frame."""
    return length + checksum.place.offset if checksum and checksum.place.offset < 0 else length


def _index(offset: int, length: int) -> int:
    return offset if offset >= 0 else length + offset

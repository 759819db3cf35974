"""CDR, the encoding of messages in ROS 2 (XCDR1), by precompiled `struct` formats.

The values of a message are one flat sequence, in the order of the definition: nested messages and arrays of
fixed length are spread out, a text is a `str`, a sequence of bytes `bytes`, any other sequence of primitives
a tuple, a sequence of messages a tuple of flat tuples. Values of fixed size that follow each other are one
`struct` format for each of the eight places modulo 8 at which they may begin; alignment counts from behind
the four bytes of the header.

`flatten` and `nest` convert between flat values and dictionaries by the names of fields.
"""

from __future__ import annotations

from functools import cache
from itertools import islice
from struct import Struct, error, unpack_from
from typing import TYPE_CHECKING, Any, Final

from mavstack.bridges.core.types.definitions import definition_of
from mavstack.bridges.core.types.model import PRIMITIVES, Container, Definition, FieldType
from mavstack.errors import CdrError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

#: The header of little-endian XCDR1.
HEADER: Final = b"\0\1\0\0"
HEADER_SIZE: Final = 4
_BIG_ENDIAN: Final = b"\0\0"
_LITTLE_ENDIAN: Final = b"\0\1"
_COUNT_SIZE: Final = 4
_BYTES: Final = ("uint8", "byte", "char")
_SIZES: Final = {"?": 1, "b": 1, "B": 1, "h": 2, "H": 2, "i": 4, "I": 4, "f": 4, "q": 8, "Q": 8, "d": 8}


class _Run:
    """Values of fixed size that follow each other."""

    def __init__(self, letters: str) -> None:
        self.letters = letters
        self.count = len(letters)
        self._structs: dict[tuple[int, str], Struct] = {}

    def struct(self, place: int, order: str) -> Struct:
        """Return the format for values that begin at `place` bytes, modulo 8."""
        key = place & 7, order
        found = self._structs.get(key)
        if found is None:
            found = self._structs[key] = Struct(order + padded(self.letters, place & 7))
        return found

    def encode(self, out: bytearray, values: Iterator[Any]) -> None:
        out += self.struct(len(out) - HEADER_SIZE, "<").pack(*islice(values, self.count))

    def decode(self, data: bytes, place: int, order: str, values: list[Any]) -> int:
        struct = self.struct(place - HEADER_SIZE, order)
        values += struct.unpack_from(data, place)
        return place + struct.size


class _Text:
    """A text."""

    def encode(self, out: bytearray, values: Iterator[Any]) -> None:
        encoded = next(values).encode()
        out += bytes(-len(out) & 3) + (len(encoded) + 1).to_bytes(_COUNT_SIZE, "little") + encoded + b"\0"

    def decode(self, data: bytes, place: int, order: str, values: list[Any]) -> int:
        size, place = _count(data, place, order, 1)
        values.append(data[place : place + max(size - 1, 0)].decode(errors="replace"))
        return place + size


class _Bytes:
    """A sequence of bytes."""

    def encode(self, out: bytearray, values: Iterator[Any]) -> None:
        content = bytes(next(values))
        out += bytes(-len(out) & 3) + len(content).to_bytes(_COUNT_SIZE, "little") + content

    def decode(self, data: bytes, place: int, order: str, values: list[Any]) -> int:
        size, place = _count(data, place, order, 1)
        values.append(data[place : place + size])
        return place + size


class _Numbers:
    """A sequence of numbers."""

    def __init__(self, letter: str) -> None:
        self._letter = letter
        self._size = _SIZES[letter]

    def encode(self, out: bytearray, values: Iterator[Any]) -> None:
        numbers = next(values)
        out += bytes(-len(out) & 3) + len(numbers).to_bytes(_COUNT_SIZE, "little")
        if numbers:
            out += bytes(-(len(out) - HEADER_SIZE) % self._size)
            out += Struct(f"<{len(numbers)}{self._letter}").pack(*numbers)

    def decode(self, data: bytes, place: int, order: str, values: list[Any]) -> int:
        count, place = _count(data, place, order, self._size)
        if not count:
            values.append(())
            return place
        place += -(place - HEADER_SIZE) % self._size
        values.append(unpack_from(f"{order}{count}{self._letter}", data, place))
        return place + count * self._size


class _Sequence:
    """A sequence of messages or texts, each a tuple of flat values (a text is its only one)."""

    def __init__(self, steps: tuple[_Step, ...], *, texts: bool) -> None:
        self._steps = steps
        self._texts = texts

    def encode(self, out: bytearray, values: Iterator[Any]) -> None:
        elements = next(values)
        out += bytes(-len(out) & 3) + len(elements).to_bytes(_COUNT_SIZE, "little")
        for element in elements:
            inner = iter((element,) if self._texts else element)
            for step in self._steps:
                step.encode(out, inner)

    def decode(self, data: bytes, place: int, order: str, values: list[Any]) -> int:
        count, place = _count(data, place, order, 1)
        elements = []
        for _ in range(count):
            inner: list[Any] = []
            for step in self._steps:
                place = step.decode(data, place, order, inner)
            elements.append(inner[0] if self._texts else tuple(inner))
        values.append(tuple(elements))
        return place


_Step = _Run | _Text | _Bytes | _Numbers | _Sequence


class Codec:
    """The encoder and decoder of one message type; made by `codec_of`."""

    def __init__(self, definition: Definition) -> None:
        #: The definition of the message type.
        self.definition = definition
        self._steps = _steps(definition)

    def encode(self, values: Iterable[Any]) -> bytes:
        """Return the bytes of flat values, with the header.

        Raises:
            CdrError: A value does not fit its type, or there are too few or too many.
        """
        out = bytearray(HEADER)
        remaining = iter(values)
        try:
            for step in self._steps:
                step.encode(out, remaining)
        except (error, StopIteration, TypeError, ValueError, AttributeError, OverflowError) as problem:
            raise CdrError(f"encoding {self.definition.name} failed: {problem}") from None
        if next(remaining, None) is not None:
            raise CdrError(f"encoding {self.definition.name} failed: there are too many values")
        return bytes(out)

    def decode(self, data: bytes) -> list[Any]:
        """Return the flat values of a message with its header; both byte orders are known.

        Raises:
            CdrError: The bytes are not such a message.
        """
        order = {_LITTLE_ENDIAN: "<", _BIG_ENDIAN: ">"}.get(bytes(data[:2]))
        if order is None or len(data) < HEADER_SIZE:
            raise CdrError(
                f"decoding {self.definition.name} failed: unknown encoding {bytes(data[:4]).hex()}"
            )
        values: list[Any] = []
        place = HEADER_SIZE
        try:
            for step in self._steps:
                place = step.decode(data, place, order, values)
        except error as problem:
            raise CdrError(f"decoding {self.definition.name} failed: {problem}") from None
        return values

    def encode_fields(self, fields: Mapping[str, Any]) -> bytes:
        """Return the bytes of a message given by the names of its fields; missing ones are 0 or empty.

        Raises:
            CdrError: A value does not fit its type, or there is no such field.
        """
        return self.encode(flatten(self.definition, fields))

    def decode_fields(self, data: bytes) -> dict[str, Any]:
        """Return the fields of a message by their names.

        Raises:
            CdrError: The bytes are not such a message.
        """
        return nest(self.definition, self.decode(data))

    def stamped(self, frame: str) -> Callable[[int, Sequence[Any]], bytes]:
        """Return an encoder of messages with a header of one frame, the fast path of publishing.

        Args:
            frame: The `frame_id`.

        Returns:
            A function of the time in nanoseconds since 1970 and the flat values behind the header. If the
            type has no header, the time does not matter, and the values are all of them.
        """
        if not self.definition.has_header:
            return lambda stamp, values: self.encode(values)
        text = frame.encode() + b"\0"
        letters = f"iII{len(text)}s"
        size = Struct("<" + letters).size
        first = self._steps[2] if len(self._steps) > 2 else None
        run = first.letters if isinstance(first, _Run) else ""
        pack = Struct(f"<4s{letters}{padded(run, size)}").pack
        count, rest = len(run), self._steps[3 if run else 2 :]

        def encode(stamp: int, values: Sequence[Any]) -> bytes:
            seconds, nanoseconds = divmod(stamp, 1_000_000_000)
            try:
                if not rest:
                    return pack(HEADER, seconds, nanoseconds, len(text), text, *values)
                out = bytearray(pack(HEADER, seconds, nanoseconds, len(text), text, *values[:count]))
                remaining = iter(values[count:])
                for step in rest:
                    step.encode(out, remaining)
            except (error, StopIteration, TypeError, ValueError, AttributeError, OverflowError) as problem:
                raise CdrError(f"encoding {self.definition.name} failed: {problem}") from None
            return bytes(out)

        return encode


@cache
def codec_of(name: str) -> Codec:
    """Return the codec of a message type.

    Args:
        name: The full name, such as "sensor_msgs/msg/Imu".

    Raises:
        InvalidArgumentError: There is no such type.
    """
    return Codec(definition_of(name))


def padded(letters: str, place: int) -> str:
    """Return a format with pad bytes, for values of natural alignment that begin at `place`."""
    parts: list[str] = []
    for letter in letters:
        pad = -place % _SIZES[letter]
        parts.append("x" * pad + letter)
        place += pad + _SIZES[letter]
    return "".join(parts)


def flatten(definition: Definition, fields: Mapping[str, Any]) -> list[Any]:
    """Return the flat values of fields by their names; missing ones are 0 or empty.

    Raises:
        CdrError: There is no such field, or an array has another length.
    """
    known = {field.name for field in definition.fields}
    if unknown := [name for name in fields if name not in known]:
        raise CdrError(f"{definition.name} has no field {unknown[0]!r}")
    values: list[Any] = []
    for field in definition.fields:
        _flatten_field(field.type, fields.get(field.name), values)
    return values


def _flatten_field(kind: FieldType, value: Any, values: list[Any]) -> None:
    inner = definition_of(kind.base) if kind.is_message else None
    if kind.container is Container.ONE:
        if inner is None:
            values.append(_default(kind) if value is None else value)
        else:
            values += flatten(inner, value or {})
    elif kind.container is Container.ARRAY:
        elements = [None] * kind.size if value is None else list(value)
        if len(elements) != kind.size:
            raise CdrError(f"an array must have {kind.size} elements, got {len(elements)}")
        for element in elements:
            _flatten_field(FieldType(kind.base, text_bound=kind.text_bound), element, values)
    elif inner is not None:
        values.append(tuple(tuple(flatten(inner, element)) for element in value or ()))
    elif isinstance(value, int):  # bytes(number) would allocate that many bytes
        raise CdrError(f"a sequence must be a list, got {value}")
    else:
        values.append(bytes(value or ()) if kind.base in _BYTES else tuple(value or ()))


def nest(definition: Definition, values: Iterable[Any]) -> dict[str, Any]:
    """Return flat values as fields by their names; nested messages are dictionaries."""
    return _nest(definition, iter(values))


def _nest(definition: Definition, values: Iterator[Any]) -> dict[str, Any]:
    return {field.name: _nest_field(field.type, values) for field in definition.fields}


def _nest_field(kind: FieldType, values: Iterator[Any]) -> Any:
    inner = definition_of(kind.base) if kind.is_message else None
    if kind.container is Container.ONE:
        return next(values) if inner is None else _nest(inner, values)
    if kind.container is Container.ARRAY:
        one = FieldType(kind.base)
        return [_nest_field(one, values) for _ in range(kind.size)]
    elements = next(values)
    return elements if inner is None else [_nest(inner, iter(element)) for element in elements]


def _default(kind: FieldType) -> Any:
    if kind.base == "string":
        return ""
    return False if kind.base == "bool" else 0


def _steps(definition: Definition) -> tuple[_Step, ...]:
    leaves: list[str | _Step] = []
    for field in definition.fields:
        leaves += _leaves(field.type)
    return _joined(leaves)


def _leaves(kind: FieldType) -> list[str | _Step]:
    """Return the leaves of a field: a letter for a value of fixed size, a step for any other."""
    if kind.container in (Container.ONE, Container.ARRAY):
        return _element(kind) * (kind.size or 1)
    if kind.is_message or kind.base == "string":
        return [_Sequence(_joined(_element(kind)), texts=kind.base == "string")]
    return [_Bytes() if kind.base in _BYTES else _Numbers(PRIMITIVES[kind.base])]


def _element(kind: FieldType) -> list[str | _Step]:
    if kind.is_message:
        return [leaf for field in definition_of(kind.base).fields for leaf in _leaves(field.type)]
    return [PRIMITIVES[kind.base] or _Text()]


def _joined(leaves: list[str | _Step]) -> tuple[_Step, ...]:
    steps: list[_Step] = []
    letters = ""
    for leaf in leaves:
        if isinstance(leaf, str):
            letters += leaf
            continue
        if letters:
            steps.append(_Run(letters))
            letters = ""
        steps.append(leaf)
    if letters:
        steps.append(_Run(letters))
    return tuple(steps)


def _count(data: bytes, place: int, order: str, element_size: int) -> tuple[int, int]:
    """Return a number of elements and the place behind it; raises if so many cannot follow."""
    place += -(place - HEADER_SIZE) & 3
    (count,) = unpack_from(f"{order}I", data, place)
    place += _COUNT_SIZE
    if count * element_size > len(data) - place:
        raise error(f"{count} elements do not fit into {len(data) - place} bytes")
    return count, place

"""Descriptor types of fields for the stubs of dialects: fields that read as one type and accept several."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Generic, Protocol, Self, TypeVar, overload

_Read_co = TypeVar("_Read_co", covariant=True)
_Written_contra = TypeVar("_Written_contra", contravariant=True)


class TypedField(Protocol, Generic[_Read_co, _Written_contra]):
    """A field that reads as one type and accepts another."""

    @overload
    def __get__(self, message: None, owner: type[Any]) -> Self: ...
    @overload
    def __get__(self, message: object, owner: type[Any]) -> _Read_co: ...
    def __get__(self, message: object, owner: type[Any]) -> _Read_co | Self:
        """Return the value of the field."""
        raise NotImplementedError

    def __set__(self, message: object, value: _Written_contra) -> None:
        """Set the value of the field."""


class Flags(TypedField[_Read_co, int], Protocol[_Read_co]):
    """A bitmask field."""


class Text(TypedField[str, str | bytes], Protocol):
    """A `char` array field."""


class Bytes(TypedField[bytes, bytes | bytearray | memoryview | Sequence[int]], Protocol):
    """A `uint8_t` array field."""


class Integers(TypedField[tuple[int, ...], Sequence[int]], Protocol):
    """An array field of other integers."""


class Floats(TypedField[tuple[float, ...], Sequence[float]], Protocol):
    """An array field of `float` or `double`."""


class Enums(TypedField[tuple[_Read_co, ...], Sequence[int]], Protocol[_Read_co]):
    """An array field of enum values."""

"""The library opendroneid-core-c, if MAVSTACK_OPENDRONEID names it, as an encoder of the same values."""

from __future__ import annotations

from ctypes import (
    CDLL,
    Structure,
    byref,
    c_char,
    c_double,
    c_float,
    c_int,
    c_uint8,
    c_uint16,
    c_uint32,
    create_string_buffer,
)
from typing import TYPE_CHECKING, Any

from mavstack.dialects import common

if TYPE_CHECKING:
    from mavstack.dialects import Message


class BasicId(Structure):
    _fields_ = [("ua_type", c_int), ("id_type", c_int), ("uas_id", c_char * 21)]


class Location(Structure):
    _fields_ = [
        ("status", c_int), ("direction", c_float), ("speed_horizontal", c_float),
        ("speed_vertical", c_float), ("latitude", c_double), ("longitude", c_double),
        ("altitude_barometric", c_float), ("altitude_geodetic", c_float), ("height_reference", c_int),
        ("height", c_float), ("horizontal_accuracy", c_int), ("vertical_accuracy", c_int),
        ("barometer_accuracy", c_int), ("speed_accuracy", c_int), ("timestamp_accuracy", c_int),
        ("timestamp", c_float),
    ]  # fmt: skip


class Authentication(Structure):
    _fields_ = [
        ("data_page", c_uint8), ("authentication_type", c_int), ("last_page_index", c_uint8),
        ("length", c_uint8), ("timestamp", c_uint32), ("authentication_data", c_uint8 * 24),
    ]  # fmt: skip


class SelfId(Structure):
    _fields_ = [("description_type", c_int), ("description", c_char * 24)]


class System(Structure):
    _fields_ = [
        ("operator_location_type", c_int), ("classification_type", c_int), ("operator_latitude", c_double),
        ("operator_longitude", c_double), ("area_count", c_uint16), ("area_radius", c_uint16),
        ("area_ceiling", c_float), ("area_floor", c_float), ("category_eu", c_int), ("class_eu", c_int),
        ("operator_altitude_geo", c_float), ("timestamp", c_uint32),
    ]  # fmt: skip


class OperatorId(Structure):
    _fields_ = [("operator_id_type", c_int), ("operator_id", c_char * 21)]


_KINDS: dict[type, tuple[str, type[Structure]]] = {
    common.OpenDroneIdBasicId: ("BasicID", BasicId),
    common.OpenDroneIdLocation: ("Location", Location),
    common.OpenDroneIdAuthentication: ("Auth", Authentication),
    common.OpenDroneIdSelfId: ("SelfID", SelfId),
    common.OpenDroneIdSystem: ("System", System),
    common.OpenDroneIdOperatorId: ("OperatorID", OperatorId),
}
_HUNDREDTHS = {"direction", "speed_horizontal", "speed_vertical"}


def encode(library: CDLL, message: Message) -> bytes:
    """Return the bytes that the library makes of a message."""
    name, kind = next(each for of, each in _KINDS.items() if isinstance(message, of))
    data = kind()
    for field, *_ in kind._fields_:
        setattr(data, field, _value(field, getattr(message, field)))
    encoded = create_string_buffer(25)
    assert getattr(library, f"encode{name}Message")(byref(encoded), byref(data)) == 0
    return encoded.raw


def _value(field: str, value: Any) -> Any:
    """Return a field in the units of the library."""
    if field in _HUNDREDTHS:
        return value / 100
    if field.endswith(("latitude", "longitude")):  # it cuts off decimals
        return (value + (0.25 if value > 0 else -0.25)) / 1e7
    if field == "authentication_data":
        return (c_uint8 * 24)(*bytes(value))
    if isinstance(value, str):
        return value.encode()
    return bytes(value).rstrip(b"\0") if isinstance(value, bytes) else value

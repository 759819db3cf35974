"""The 25-byte messages that a Remote ID module broadcasts by Wi-Fi and Bluetooth, from and to MAVLink.

Each begins with its type and the version of the protocol (ASTM F3411, version 2). Numbers are little-endian;
altitudes are in half metres above -1000 m, the direction is split at south, and speeds have two resolutions.
A pack joins up to nine of them. Single precision is kept where the rounding depends on it.
"""

from __future__ import annotations

import struct
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from mavstack.dialects import Message

SIZE: Final = 25
MAX_IN_PACK: Final = 9
VERSION: Final = 2
_PACK: Final = 0xF
_ID_SIZE, _TEXT_SIZE = 20, 23
_FIRST_PAGE, _NEXT_PAGES = 17, 23
_SLOW: Final = 6375
_MAX_TIME: Final = 36_000
_UNKNOWN_TIME: Final = 0xFFFF
_LOCATION: Final = struct.Struct("<BBBBbiiHHHBBHBx")
_SYSTEM: Final = struct.Struct("<BBiiHBHHBHIx")
_AUTHENTICATION: Final = struct.Struct("<BBBBI17s")


def encode_broadcast(message: Message) -> bytes:
    """Return the broadcast of a Remote ID message.

    Args:
        message: An OPEN_DRONE_ID_BASIC_ID, LOCATION, AUTHENTICATION, SELF_ID, SYSTEM or OPERATOR_ID.

    Returns:
        25 bytes.

    Raises:
        InvalidArgumentError: The message is another one, or a number is out of its range.
    """
    for number, (kind, encode, _) in _KINDS.items():
        if isinstance(message, kind):
            try:
                return encode(number << 4 | VERSION, message)
            except (struct.error, OverflowError) as error:
                raise InvalidArgumentError(f"{kind.__name__} cannot be broadcast: {error}") from None
    raise InvalidArgumentError(f"{type(message).__name__} is not a message of Remote ID")


def encode_pack(messages: Sequence[Message]) -> bytes:
    """Return the broadcast of several messages in one.

    Args:
        messages: One to nine messages.

    Returns:
        3 bytes, and 25 for each message.

    Raises:
        InvalidArgumentError: There are too many messages, or one cannot be broadcast.
    """
    if not 1 <= len(messages) <= MAX_IN_PACK:
        raise InvalidArgumentError(f"a pack has 1 to {MAX_IN_PACK} messages, got {len(messages)}")
    body = b"".join(encode_broadcast(message) for message in messages)
    return bytes([_PACK << 4 | VERSION, SIZE, len(messages)]) + body


def decode_broadcast(data: bytes) -> list[Message]:
    """Return the MAVLink messages of a broadcast; those of unknown types are left out.

    Args:
        data: A message of 25 bytes, or a pack.

    Returns:
        The messages.

    Raises:
        InvalidArgumentError: The data is too short.
    """
    if data and data[0] >> 4 == _PACK:
        count = data[2] if len(data) > 2 and data[1] == SIZE else MAX_IN_PACK + 1
        if count > MAX_IN_PACK or len(data) < 3 + count * SIZE:
            raise InvalidArgumentError("a pack of Remote ID is damaged or too short")
        parts = [data[3 + at * SIZE : 3 + (at + 1) * SIZE] for at in range(count)]
        return [message for part in parts if part[0] >> 4 != _PACK for message in decode_broadcast(part)]
    if len(data) < SIZE:
        raise InvalidArgumentError(f"a message of Remote ID has {SIZE} bytes, got {len(data)}")
    found = _KINDS.get(data[0] >> 4)
    return [] if found is None else [found[2](bytes(data[:SIZE]))]


# Basic id, self id, operator id


def _encode_basic(head: int, message: common.OpenDroneIdBasicId) -> bytes:
    types = _nibbles(message.id_type, message.ua_type)
    return bytes([head, types]) + bytes(message.uas_id)[:_ID_SIZE].ljust(_ID_SIZE, b"\0") + bytes(3)


def _decode_basic(data: bytes) -> Message:
    return common.OpenDroneIdBasicId(id_type=data[1] >> 4, ua_type=data[1] & 15, uas_id=data[2:22])


def _encode_self(head: int, message: common.OpenDroneIdSelfId) -> bytes:
    return bytes([head, message.description_type]) + _text(message.description, _TEXT_SIZE)


def _decode_self(data: bytes) -> Message:
    return common.OpenDroneIdSelfId(description_type=data[1], description=_read_text(data[2:25]))


def _encode_operator(head: int, message: common.OpenDroneIdOperatorId) -> bytes:
    return bytes([head, message.operator_id_type]) + _text(message.operator_id, _ID_SIZE) + bytes(3)


def _decode_operator(data: bytes) -> Message:
    return common.OpenDroneIdOperatorId(operator_id_type=data[1], operator_id=_read_text(data[2:22]))


# Location


def _encode_location(head: int, message: common.OpenDroneIdLocation) -> bytes:
    direction = (int(message.direction) + 50) // 100
    direction = 0 if direction == 360 else direction
    is_west, is_fast, speed = direction >= 180, message.speed_horizontal > _SLOW, message.speed_horizontal
    speed = min((2 * (speed - _SLOW) + 75) // 150, 255) if is_fast else (2 * speed + 25) // 50
    flags = message.status << 4 | message.height_reference << 2 | is_west << 1 | is_fast
    return _LOCATION.pack(
        head,
        flags,
        min(direction - 180 * is_west, 255),
        speed,
        max(min(int(message.speed_vertical / 50), 127), -128),
        message.latitude,
        message.longitude,
        _altitude(message.altitude_barometric),
        _altitude(message.altitude_geodetic),
        _altitude(message.height),
        _nibbles(message.vertical_accuracy, message.horizontal_accuracy),
        _nibbles(message.barometer_accuracy, message.speed_accuracy),
        _tenths(message.timestamp),
        _nibbles(0, message.timestamp_accuracy),
    )


def _decode_location(data: bytes) -> Message:
    _, flags, direction, speed, climb, lat, lon, baro, geo, height, positions, speeds, time, times = (
        _LOCATION.unpack(data)
    )
    return common.OpenDroneIdLocation(
        status=flags >> 4,
        height_reference=flags >> 2 & 1,
        direction=(direction + 180 * (flags >> 1 & 1)) * 100,
        speed_horizontal=_SLOW + 75 * speed if flags & 1 else 25 * speed,
        speed_vertical=climb * 50,
        latitude=lat,
        longitude=lon,
        altitude_barometric=_metres(baro),
        altitude_geodetic=_metres(geo),
        height=_metres(height),
        vertical_accuracy=positions >> 4,
        horizontal_accuracy=positions & 15,
        barometer_accuracy=speeds >> 4,
        speed_accuracy=speeds & 15,
        timestamp=_UNKNOWN_TIME if time == _UNKNOWN_TIME else time / 10,
        timestamp_accuracy=times & 15,
    )


# System, authentication


def _encode_system(head: int, message: common.OpenDroneIdSystem) -> bytes:
    return _SYSTEM.pack(
        head,
        (message.classification_type & 7) << 2 | message.operator_location_type & 3,
        message.operator_latitude,
        message.operator_longitude,
        message.area_count,
        min(message.area_radius // 10, 255),
        _altitude(message.area_ceiling),
        _altitude(message.area_floor),
        _nibbles(message.category_eu, message.class_eu),
        _altitude(message.operator_altitude_geo),
        message.timestamp,
    )


def _decode_system(data: bytes) -> Message:
    _, flags, lat, lon, count, radius, ceiling, floor, kind, altitude, timestamp = _SYSTEM.unpack(data)
    return common.OpenDroneIdSystem(
        operator_location_type=flags & 3,
        classification_type=flags >> 2 & 7,
        operator_latitude=lat,
        operator_longitude=lon,
        area_count=count,
        area_radius=radius * 10,
        area_ceiling=_metres(ceiling),
        area_floor=_metres(floor),
        category_eu=kind >> 4,
        class_eu=kind & 15,
        operator_altitude_geo=_metres(altitude),
        timestamp=timestamp,
    )


def _encode_authentication(head: int, message: common.OpenDroneIdAuthentication) -> bytes:
    kind = _nibbles(message.authentication_type, message.data_page)
    data = bytes(message.authentication_data)
    if message.data_page:
        return bytes([head, kind]) + data[:_NEXT_PAGES].ljust(_NEXT_PAGES, b"\0")
    return _AUTHENTICATION.pack(
        head, kind, message.last_page_index, message.length, message.timestamp, data[:_FIRST_PAGE]
    )


def _decode_authentication(data: bytes) -> Message:
    kind, page = data[1] >> 4, data[1] & 15
    if page:
        return common.OpenDroneIdAuthentication(
            authentication_type=kind, data_page=page, authentication_data=data[2:25]
        )
    _, _, last, length, timestamp, content = _AUTHENTICATION.unpack(data)
    return common.OpenDroneIdAuthentication(
        authentication_type=kind,
        last_page_index=last,
        length=length,
        timestamp=timestamp,
        authentication_data=content.ljust(_NEXT_PAGES, b"\0"),
    )


# Fields


def _nibbles(high: int, low: int) -> int:
    if not (0 <= high <= 15 and 0 <= low <= 15):
        raise InvalidArgumentError(f"types and accuracies must be 0 to 15, got {high} and {low}")
    return high << 4 | low


def _single(value: float) -> float:
    """Return a number in single precision."""
    found: float = struct.unpack("<f", struct.pack("<f", value))[0]
    return found


def _altitude(metres: float) -> int:
    return min(max(int(_single(_single(metres) + 1000.0) / 0.5), 0), 0xFFFF)


def _metres(value: int) -> float:
    return value * 0.5 - 1000.0


def _tenths(seconds: float) -> int:
    if seconds == _UNKNOWN_TIME:
        return _UNKNOWN_TIME
    return min(max(int(_single(_single(seconds) * 10) + 0.5), 0), _MAX_TIME)


def _text(text: str, size: int) -> bytes:
    return text.encode("ascii", "replace")[:size].ljust(size, b"\0")


def _read_text(data: bytes) -> str:
    return data.split(b"\0")[0].decode("ascii", "replace")


_KINDS: Final[Mapping[int, tuple[type[Message], Callable[[int, Any], bytes], Callable[[bytes], Message]]]] = (
    MappingProxyType(
        {
            0: (common.OpenDroneIdBasicId, _encode_basic, _decode_basic),
            1: (common.OpenDroneIdLocation, _encode_location, _decode_location),
            2: (common.OpenDroneIdAuthentication, _encode_authentication, _decode_authentication),
            3: (common.OpenDroneIdSelfId, _encode_self, _decode_self),
            4: (common.OpenDroneIdSystem, _encode_system, _decode_system),
            5: (common.OpenDroneIdOperatorId, _encode_operator, _decode_operator),
        }
    )
)

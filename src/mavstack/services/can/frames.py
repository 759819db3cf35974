"""Frames of a CAN bus, and the messages that carry them (CAN_FRAME, CANFD_FRAME).

The id of a message has the flags of Linux' SocketCAN in its upper bits: 31 extended, 30 remote, 29 error.
"""

from __future__ import annotations

from typing import Final, NamedTuple

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError

EXTENDED: Final = 1 << 31
REMOTE: Final = 1 << 30
ERROR: Final = 1 << 29
MAX_ID: Final = (1 << 29) - 1
MAX_STANDARD_ID: Final = (1 << 11) - 1
#: The largest number of data bytes in a classic CAN frame.
MAX_DATA: Final = 8
#: The largest number of data bytes in a CAN FD frame.
MAX_FD_DATA: Final = 64


class CanFrame(NamedTuple):
    """A frame of a CAN bus.

    Attributes:
        id: The identifier: 29 bits, or 11 bits unless `extended`.
        data: Up to 8 bytes, or 64 bytes with `fd`.
        extended: True for an identifier of 29 bits.
        remote: True for a remote transmission request.
        error: True for an error frame.
        fd: True for a frame of CAN FD.
    """

    id: int
    data: bytes = b""
    extended: bool = True
    remote: bool = False
    error: bool = False
    fd: bool = False


def to_message(
    frame: CanFrame, bus: int, system: int = 0, component: int = 0
) -> common.CanFrame | common.CanfdFrame:
    """Return the message that carries a frame.

    Args:
        frame: The frame.
        bus: The number of the bus, from 1; the message counts from 0.
        system: The target system.
        component: The target component.

    Raises:
        InvalidArgumentError: The identifier or the data is too long.
    """
    limit = MAX_FD_DATA if frame.fd else MAX_DATA
    if not 0 <= frame.id <= (MAX_ID if frame.extended else MAX_STANDARD_ID):
        raise InvalidArgumentError(f"the identifier {frame.id:#x} of a CAN frame is out of range")
    if len(frame.data) > limit:
        raise InvalidArgumentError(f"a CAN frame has at most {limit} bytes, got {len(frame.data)}")
    flags = EXTENDED * frame.extended | REMOTE * frame.remote | ERROR * frame.error
    kind = common.CanfdFrame if frame.fd else common.CanFrame
    data = bytes(frame.data)
    return kind(
        target_system=system,
        target_component=component,
        bus=bus - 1,
        len=len(data),
        id=frame.id | flags,
        data=data,
    )


def from_message(message: common.CanFrame | common.CanfdFrame) -> CanFrame:
    """Return the frame that a message carries; a length above the limit is cut."""
    number = message.id
    return CanFrame(
        number & MAX_ID,
        bytes(message.data[: message.len]),
        bool(number & EXTENDED),
        bool(number & REMOTE),
        bool(number & ERROR),
        isinstance(message, common.CanfdFrame),
    )


def dronecan_type(number: int) -> int:
    """Return the data type of a DroneCAN frame from its identifier, as ArduPilot's filter does."""
    if not number & 0xFF:
        return 0  # a frame of an anonymous node
    return number >> 16 & 0xFF if number & 0x80 else number >> 8 & 0xFFFF

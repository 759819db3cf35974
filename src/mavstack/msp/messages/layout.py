"""Typed messages out of tables of facts: the class body of a message is its layout.

    @reply(MspCommand.MSP_ALTITUDE)
    class Altitude(TableMessage):
        altitude: float = i32(100, "m")
        climb_rate: float = i16(100, "m/s")
        baro_altitude: float | None = i32(100, "m", variant="INAV", default=None)

Each class is a frozen dataclass that decodes and encodes itself, since a simulated controller sends what a
client receives. Firmwares append fields at the end of a payload: a field with `default=None` may be
missing, and the fields after it with it. Bytes behind the last known field belong to a newer firmware and
are ignored. Fields with a `variant` exist in that firmware only; of an unknown firmware the layout of
Betaflight is assumed, from which most others descend.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, Self, TypeVar

from mavstack.errors import InvalidArgumentError, InvalidTypeError, MspDecodeError
from mavstack.msp.commands import command_name
from mavstack.msp.firmware_info import BETAFLIGHT, INAV, FirmwareInfo
from mavstack.msp.messages.base import MspMessage
from mavstack.msp.messages.codecs import PayloadReader, PayloadWriter
from mavstack.msp.messages.fields import (
    Layout,
    PayloadEndsInFieldError,
    decode_fields,
    encode_fields,
    layout_of,
)

if TYPE_CHECKING:
    from collections.abc import Callable

EVERY_FIRMWARE = (BETAFLIGHT, INAV)
BETAFLIGHT_ONLY = (BETAFLIGHT,)
INAV_ONLY = (INAV,)

MessageT = TypeVar("MessageT", bound="TableMessage")


class TableMessage(Layout, MspMessage):
    """A message whose class body is its layout.

    Attributes:
        VARIANTS: The firmwares that know the message.
        SINCE: Version of Betaflight's MSP interface that added the message, "" for an old one.
        IS_REPLY: True for a message that the flight controller sends, False for one that it receives.
    """

    __slots__ = ()

    VARIANTS: ClassVar[tuple[str, ...]] = EVERY_FIRMWARE
    SINCE: ClassVar[str] = ""
    IS_REPLY: ClassVar[bool] = True

    @classmethod
    def decode(cls, payload: bytes, firmware: FirmwareInfo | None = None) -> Self:
        """Decode a payload.

        Args:
            payload: The payload of a frame.
            firmware: Whose layout applies; None means the newest Betaflight.

        Returns:
            The message. Fields that the firmware does not send are None.

        Raises:
            MspDecodeError: The payload is too short.
        """
        try:
            return cls(**decode_fields(cls, PayloadReader(payload, firmware)))
        except PayloadEndsInFieldError as error:
            answer = f"payload of {len(payload)} bytes ends in {error.name}, {error.missing} more are needed"
            raise MspDecodeError("decoding", cls.NAME, answer=answer) from None

    def encode(self, firmware: FirmwareInfo | None = None) -> bytes:
        """Encode the payload.

        Args:
            firmware: The firmware that receives the payload: fields that it does not know are left out. None
                means the newest Betaflight.

        Raises:
            InvalidArgumentError: A value does not fit into its field, or a field is None before one that is
                not.
            InvalidTypeError: A value has a wrong type.
        """
        payload = PayloadWriter()
        payload.firmware = firmware
        try:
            encode_fields(self, payload)
        except (InvalidArgumentError, InvalidTypeError) as error:
            raise type(error)(f"encoding {self.NAME} failed: {error}") from None
        return bytes(payload)

    @classmethod
    def from_message(cls, message: MspMessage, **changes: object) -> Self:
        """Make a message from the fields that it has in common with another one.

        Args:
            message: Mostly the reply whose settings are to be written back.
            changes: Values of fields that are to differ.

        Raises:
            InvalidArgumentError: A field of `changes` does not exist.
        """
        names = layout_of(cls)
        if unknown := changes.keys() - names.keys():
            raise InvalidArgumentError(f"{cls.NAME} has no field {', '.join(sorted(unknown))}")
        common = {name: getattr(message, name) for name in names if hasattr(message, name)}
        return cls(**(common | changes))


def _define(
    made: type[MessageT], command: int, is_reply: bool, variants: tuple[str, ...], since: str
) -> type[MessageT]:
    layout = dataclass(frozen=True, slots=True)(made)
    layout.COMMAND = int(command)
    layout.NAME = command_name(command, FirmwareInfo(variants[0]))
    layout.IS_REPLY, layout.VARIANTS, layout.SINCE = is_reply, variants, since
    return layout


def reply(
    command: int, variants: tuple[str, ...] = EVERY_FIRMWARE, since: str = ""
) -> Callable[[type[MessageT]], type[MessageT]]:
    """Define a message that the flight controller sends.

    Args:
        command: Its number, which is also the number of the request for it.
        variants: The firmwares that send it.
        since: Version of Betaflight's MSP interface that added it.
    """
    return lambda made: _define(made, command, True, variants, since)


def request(
    command: int, variants: tuple[str, ...] = EVERY_FIRMWARE, since: str = ""
) -> Callable[[type[MessageT]], type[MessageT]]:
    """Define a message that the flight controller receives.

    Args:
        command: Its number.
        variants: The firmwares that accept it.
        since: Version of Betaflight's MSP interface that added it.
    """
    return lambda made: _define(made, command, False, variants, since)

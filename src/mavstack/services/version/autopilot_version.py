"""The content of AUTOPILOT_VERSION, decoded.

A version is four bytes: major, minor, patch, and a FIRMWARE_VERSION_TYPE. A git hash is eight bytes, which
ArduPilot fills with the letters of the hash and PX4 with a little-endian number.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

from mavstack.dialects import common

if TYPE_CHECKING:
    from typing import Self

_HEXADECIMAL = frozenset(b"0123456789abcdefABCDEF")
#: The length of the identifier of a firmware that uses MSP.
_IDENTIFIER = 4


class FirmwareVersion(NamedTuple):
    """A version number as MAVLink packs it into 32 bits; `kind` is a FIRMWARE_VERSION_TYPE."""

    major: int
    minor: int
    patch: int = 0
    kind: int = common.FirmwareVersionType.OFFICIAL

    @classmethod
    def unpack(cls, packed: int) -> Self:
        """Unpack the field of a message."""
        kind = packed & 0xFF
        return cls(packed >> 24 & 0xFF, packed >> 16 & 0xFF, packed >> 8 & 0xFF, kind)

    def pack(self) -> int:
        """Pack the version for the field of a message."""
        return self.major << 24 | self.minor << 16 | self.patch << 8 | self.kind

    @property
    def kind_name(self) -> str:
        """The release type, such as "beta"; between two types, the lower one."""
        steps = sorted(common.FirmwareVersionType, reverse=True)
        return next(step.name.lower() for step in steps if step <= self.kind)

    def __str__(self) -> str:
        number = f"{self.major}.{self.minor}.{self.patch}"
        return number if self.kind == common.FirmwareVersionType.OFFICIAL else f"{number}-{self.kind_name}"


UNKNOWN = FirmwareVersion(0, 0, 0, 0)


def identifier(custom: bytes) -> str:
    """Return the letters by which a firmware names itself in MSP, such as "BTFL"; "" if there are none."""
    letters = custom.rstrip(b"\0")
    named = len(letters) == _IDENTIFIER and letters.isalnum() and not _HEXADECIMAL.issuperset(letters)
    return letters.decode("ascii") if named else ""


def git_hash(custom: bytes) -> str:
    """Return the git hash in a custom version field; "" if there is none."""
    if not any(custom) or identifier(custom):
        return ""
    letters = custom.rstrip(b"\0")
    if letters and _HEXADECIMAL.issuperset(letters):
        return letters.decode("ascii").lower()
    return custom[::-1].hex()


@dataclass(frozen=True, slots=True)
class AutopilotVersion:
    """The software, hardware and capabilities of a component."""

    capabilities: int = 0
    flight: FirmwareVersion = UNKNOWN
    middleware: FirmwareVersion = UNKNOWN
    operating_system: FirmwareVersion = UNKNOWN
    board_version: int = 0
    vendor_id: int = 0
    product_id: int = 0
    uid: int = 0
    uid2: bytes = b""
    flight_custom: bytes = bytes(8)
    middleware_custom: bytes = bytes(8)
    operating_system_custom: bytes = bytes(8)

    def can(self, capability: int) -> bool:
        """Return whether the component has all of these MAV_PROTOCOL_CAPABILITY flags."""
        return self.capabilities & capability == capability

    @property
    def git_hash(self) -> str:
        """The git hash of the flight software."""
        return git_hash(self.flight_custom)

    @property
    def identifier(self) -> str:
        """The identifier of a firmware that speaks MSP, such as "BTFL" or "INAV"; "" for all others."""
        return identifier(self.flight_custom)

    @property
    def board(self) -> tuple[int, int, int]:
        """The hardware: vendor, product and board version."""
        return self.vendor_id, self.product_id, self.board_version

    @property
    def unique_id(self) -> str:
        """The unique id of the board in hexadecimal, the long one if available; "" if there is none."""
        if any(self.uid2):
            return self.uid2.hex()
        return f"{self.uid:016x}" if self.uid else ""

    @classmethod
    def read(cls, message: common.AutopilotVersion) -> Self:
        """Return the content of a message."""
        return cls(
            capabilities=int(message.capabilities),
            flight=FirmwareVersion.unpack(message.flight_sw_version),
            middleware=FirmwareVersion.unpack(message.middleware_sw_version),
            operating_system=FirmwareVersion.unpack(message.os_sw_version),
            board_version=message.board_version,
            vendor_id=message.vendor_id,
            product_id=message.product_id,
            uid=message.uid,
            uid2=message.uid2,
            flight_custom=message.flight_custom_version,
            middleware_custom=message.middleware_custom_version,
            operating_system_custom=message.os_custom_version,
        )

    def to_message(self) -> common.AutopilotVersion:
        """Return the message."""
        return common.AutopilotVersion(
            capabilities=self.capabilities,
            flight_sw_version=self.flight.pack(),
            middleware_sw_version=self.middleware.pack(),
            os_sw_version=self.operating_system.pack(),
            board_version=self.board_version,
            vendor_id=self.vendor_id,
            product_id=self.product_id,
            uid=self.uid,
            uid2=self.uid2,
            flight_custom_version=self.flight_custom,
            middleware_custom_version=self.middleware_custom,
            os_custom_version=self.operating_system_custom,
        )

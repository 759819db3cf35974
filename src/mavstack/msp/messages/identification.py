"""Messages by which a flight controller says what it is; all firmwares have them.

Sources: `msp.c` of Betaflight, `fc_msp.c` of iNav.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, Final, Self

from mavstack.errors import InvalidArgumentError, MspDecodeError
from mavstack.msp.firmware_info import FirmwareInfo
from mavstack.msp.messages.base import MspMessage

if TYPE_CHECKING:
    from collections.abc import Mapping

_DATE_LENGTH, _TIME_LENGTH, _REVISION_LENGTH = 11, 8, 7
_SIGNATURE_LENGTH: Final = 32


@dataclass(frozen=True, slots=True)
class ApiVersion(MspMessage):
    """MSP_API_VERSION (1): the version of the protocol and of its messages."""

    COMMAND: ClassVar[int] = 1
    NAME: ClassVar[str] = "MSP_API_VERSION"

    protocol: int
    major: int
    minor: int

    @classmethod
    def decode(cls, payload: bytes, firmware: FirmwareInfo | None = None) -> Self:  # noqa: D102
        _require(cls, payload, 3)
        return cls(*payload[:3])

    def encode(self, firmware: FirmwareInfo | None = None) -> bytes:  # noqa: D102
        return _octets(self, self.protocol, self.major, self.minor)


@dataclass(frozen=True, slots=True)
class FcVariant(MspMessage):
    """MSP_FC_VARIANT (2): four letters that name the firmware, `BTFL` or `INAV`."""

    COMMAND: ClassVar[int] = 2
    NAME: ClassVar[str] = "MSP_FC_VARIANT"

    variant: str

    @classmethod
    def decode(cls, payload: bytes, firmware: FirmwareInfo | None = None) -> Self:  # noqa: D102
        _require(cls, payload, 4)
        return cls(_text(payload[:4]))

    def encode(self, firmware: FirmwareInfo | None = None) -> bytes:  # noqa: D102
        return _fixed(self, self.variant, 4)


@dataclass(frozen=True, slots=True)
class FcVersion(MspMessage):
    """MSP_FC_VERSION (3): the version of the firmware; the year of Betaflight counts from 2000.

    Attributes:
        text: The version as text, with suffixes such as `-alpha`; None below API 1.47.
    """

    COMMAND: ClassVar[int] = 3
    NAME: ClassVar[str] = "MSP_FC_VERSION"

    major: int
    minor: int
    patch: int
    text: str | None = None

    @classmethod
    def decode(cls, payload: bytes, firmware: FirmwareInfo | None = None) -> Self:  # noqa: D102
        _require(cls, payload, 3)
        text = _prefixed(cls, payload, 3)[0] if len(payload) > 3 else None
        return cls(payload[0], payload[1], payload[2], text)

    def encode(self, firmware: FirmwareInfo | None = None) -> bytes:  # noqa: D102
        text = b"" if self.text is None else _with_length(self, self.text)
        return _octets(self, self.major, self.minor, self.patch) + text


@dataclass(frozen=True, slots=True)
class BoardInfo(MspMessage):
    """MSP_BOARD_INFO (4): the board and the target of the build.

    Attributes:
        board: Identifier of the board, four characters.
        hardware_revision: Revision of the board, 0: not known.
        osd: Kind of the board: 2 has an analog OSD chip; None in old firmwares.
        capabilities: Bits of the target's capabilities.
        target: Name of the target.
        board_name: Name of the board; Betaflight only.
        manufacturer: Identifier of the manufacturer; Betaflight only.
        rest: Bytes of the fields behind them, which nothing here uses: signature, processor, sample rate.
    """

    COMMAND: ClassVar[int] = 4
    NAME: ClassVar[str] = "MSP_BOARD_INFO"

    board: str
    hardware_revision: int = 0
    osd: int | None = None
    capabilities: int | None = None
    target: str | None = None
    board_name: str | None = None
    manufacturer: str | None = None
    rest: bytes = b""

    @classmethod
    def decode(cls, payload: bytes, firmware: FirmwareInfo | None = None) -> Self:  # noqa: D102
        _require(cls, payload, 6)
        osd, capabilities = (payload[at] if len(payload) > at else None for at in (6, 7))
        texts: list[str | None] = []
        position = 8
        for _ in range(3):
            text, position = (
                _prefixed(cls, payload, position) if len(payload) > position else (None, position)
            )
            texts.append(text)
        revision = int.from_bytes(payload[4:6], "little")
        target, name, manufacturer = texts
        return cls(
            _text(payload[:4]), revision, osd, capabilities, target, name, manufacturer, payload[position:]
        )

    def encode(self, firmware: FirmwareInfo | None = None) -> bytes:  # noqa: D102
        data = _fixed(self, self.board, 4) + _octets(
            self, self.hardware_revision & 0xFF, self.hardware_revision >> 8
        )
        for octet in (self.osd, self.capabilities):
            if octet is None:
                return data
            data += _octets(self, octet)
        for text in (self.target, self.board_name, self.manufacturer):
            if text is None:
                return data
            data += _with_length(self, text)
        return data + self.rest


@dataclass(frozen=True, slots=True)
class BuildInfo(MspMessage):
    """MSP_BUILD_INFO (5): date, time and revision of the build.

    Attributes:
        date: Such as "Nov 22 2026".
        time: Such as "21:10:03".
        revision: First digits of the commit.
        options: Numbers of the options of the build; empty below API 1.46 of Betaflight.
    """

    COMMAND: ClassVar[int] = 5
    NAME: ClassVar[str] = "MSP_BUILD_INFO"

    date: str
    time: str
    revision: str = ""
    options: tuple[int, ...] = ()

    @classmethod
    def decode(cls, payload: bytes, firmware: FirmwareInfo | None = None) -> Self:  # noqa: D102
        start = _DATE_LENGTH + _TIME_LENGTH
        _require(cls, payload, start)
        rest = payload[start:]
        # iNav sends revisions of 7 to 15 characters and nothing behind them, Betaflight 7 and the options.
        is_text = rest.isalnum() if firmware is None or not firmware.variant else firmware.is_inav
        length = len(rest) if is_text else _REVISION_LENGTH
        octets = rest[length:]
        options = tuple(int.from_bytes(octets[at : at + 2], "little") for at in range(0, len(octets) - 1, 2))
        return cls(
            _text(payload[:_DATE_LENGTH]), _text(payload[_DATE_LENGTH:start]), _text(rest[:length]), options
        )

    def encode(self, firmware: FirmwareInfo | None = None) -> bytes:  # noqa: D102
        data = _fixed(self, self.date, _DATE_LENGTH) + _fixed(self, self.time, _TIME_LENGTH)
        data += _fixed(self, self.revision, max(_REVISION_LENGTH, len(self.revision)))
        return data + b"".join(option.to_bytes(2, "little") for option in self.options)


@dataclass(frozen=True, slots=True)
class Name(MspMessage):
    """MSP_NAME (10): the name of the craft, set by its user."""

    COMMAND: ClassVar[int] = 10
    NAME: ClassVar[str] = "MSP_NAME"

    name: str

    @classmethod
    def decode(cls, payload: bytes, firmware: FirmwareInfo | None = None) -> Self:  # noqa: D102
        return cls(_text(payload))

    def encode(self, firmware: FirmwareInfo | None = None) -> bytes:  # noqa: D102
        return self.name.encode("ascii", "replace")


@dataclass(frozen=True, slots=True)
class Uid(MspMessage):
    """MSP_UID (160): the unique identifier of the processor, in 24 hexadecimal digits as in the CLI."""

    COMMAND: ClassVar[int] = 160
    NAME: ClassVar[str] = "MSP_UID"

    uid: str

    @classmethod
    def decode(cls, payload: bytes, firmware: FirmwareInfo | None = None) -> Self:  # noqa: D102
        _require(cls, payload, 12)
        return cls("".join(payload[at : at + 4][::-1].hex() for at in (0, 4, 8)))

    def encode(self, firmware: FirmwareInfo | None = None) -> bytes:  # noqa: D102
        words = bytes.fromhex(self.uid.rjust(24, "0"))
        return b"".join(words[at : at + 4][::-1] for at in (0, 4, 8))


#: The messages from which `firmware_info` makes a `FirmwareInfo`; only the first three exist in every
#: firmware.
IDENTIFICATION: Final[tuple[type[MspMessage], ...]] = (
    ApiVersion,
    FcVariant,
    FcVersion,
    BoardInfo,
    BuildInfo,
    Name,
    Uid,
)


def firmware_info(messages: Mapping[type[MspMessage], MspMessage]) -> FirmwareInfo:
    """Return the identity from messages of `IDENTIFICATION`; the fields of missing ones are empty."""
    found = {type(message): message for message in messages.values()}
    api, variant, version = found.get(ApiVersion), found.get(FcVariant), found.get(FcVersion)
    board, build = found.get(BoardInfo), found.get(BuildInfo)
    name, uid = found.get(Name), found.get(Uid)
    return FirmwareInfo(
        variant=variant.variant if isinstance(variant, FcVariant) else "",
        version=(version.major, version.minor, version.patch)
        if isinstance(version, FcVersion)
        else (0, 0, 0),
        api=(api.major, api.minor) if isinstance(api, ApiVersion) else (0, 0),
        board=board.board if isinstance(board, BoardInfo) else "",
        target=board.target or "" if isinstance(board, BoardInfo) else "",
        build=f"{build.date} {build.time} {build.revision}".strip() if isinstance(build, BuildInfo) else "",
        name=name.name if isinstance(name, Name) else "",
        uid=uid.uid if isinstance(uid, Uid) else "",
        release=version.text or "" if isinstance(version, FcVersion) else "",
    )


def _require(kind: type[MspMessage], payload: bytes, size: int) -> None:
    if len(payload) < size:
        answer = f"{size} bytes expected, got {len(payload)}"
        raise MspDecodeError("decoding", kind.NAME, answer=answer)


def _prefixed(kind: type[MspMessage], payload: bytes, position: int) -> tuple[str, int]:
    """Return a text behind its length, and the position after it."""
    end = position + 1 + payload[position]
    _require(kind, payload, end)
    return _text(payload[position + 1 : end]), end


def _text(data: bytes) -> str:
    text = data.split(b"\0")[0].decode("ascii", "replace").strip()
    return "".join(letter if letter.isprintable() else "\ufffd" for letter in text)


def _fixed(message: MspMessage, text: str, length: int) -> bytes:
    data = text.encode("ascii", "replace")
    if len(data) > length:
        raise InvalidArgumentError(f"{message.NAME}: {text!r} must have at most {length} characters")
    return data.ljust(length, b"\0")


def _with_length(message: MspMessage, text: str) -> bytes:
    data = _fixed(message, text, min(len(text), 255))
    return bytes([len(data)]) + data


def _octets(message: MspMessage, *numbers: int) -> bytes:
    if not all(0 <= number <= 255 for number in numbers):
        raise InvalidArgumentError(f"{message.NAME}: numbers must be 0 to 255, got {numbers}")
    return bytes(numbers)

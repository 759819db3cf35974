from __future__ import annotations

import pytest

from mavstack import InvalidArgumentError, MspDecodeError
from mavstack.msp import FirmwareInfo
from mavstack.msp.messages import (
    ApiVersion,
    BoardInfo,
    BuildInfo,
    FcVariant,
    FcVersion,
    MspMessage,
    Name,
    Uid,
)
from mavstack.msp.messages.identification import firmware_info

#: Payloads as of Betaflight's SITL, and of iNav.
PAYLOADS: list[tuple[type[MspMessage], bytes, MspMessage]] = [
    (ApiVersion, b"\x00\x01\x31", ApiVersion(0, 1, 49)),
    (FcVariant, b"BTFL", FcVariant("BTFL")),
    (FcVersion, b"\x04\x05\x01", FcVersion(4, 5, 1)),
    (FcVersion, b"\x1a\x0c\x00\x0f2026.12.0-alpha", FcVersion(26, 12, 0, "2026.12.0-alpha")),
    (BoardInfo, b"SITL\x00\x00", BoardInfo("SITL")),
    (
        BoardInfo,
        b"SITL\x01\x02\x00\x02\x04SITL\x00\x00" + bytes(33),
        BoardInfo("SITL", 0x201, 0, 2, "SITL", "", "", bytes(33)),
    ),
    (
        BuildInfo,
        b"Nov 22 202621:10:03abc1234\x01\x10\xff\x0f",
        BuildInfo("Nov 22 2026", "21:10:03", "abc1234", (4097, 4095)),
    ),
    (BuildInfo, b"Nov 22 202621:10:03abc12345", BuildInfo("Nov 22 2026", "21:10:03", "abc12345")),
    (Name, b"my quad", Name("my quad")),
    (Name, b"", Name("")),
    (Uid, bytes(range(12)), Uid("0302010007060504" + "0b0a0908")),
]


@pytest.mark.parametrize(("kind", "payload", "message"), PAYLOADS)
def test_payloads_in_both_directions(kind: type[MspMessage], payload: bytes, message: MspMessage) -> None:
    assert kind.decode(payload) == message
    assert message.encode() == payload


@pytest.mark.parametrize(
    ("kind", "payload"),
    [
        (ApiVersion, b"\0\1"),
        (FcVariant, b"BTF"),
        (FcVersion, b""),
        (BoardInfo, b"SITL\0"),
        (BoardInfo, b"SITL\0\0\0\0\x09SITL"),
        (BuildInfo, bytes(18)),
        (Uid, bytes(11)),
    ],
)
def test_a_payload_that_is_too_short(kind: type[MspMessage], payload: bytes) -> None:
    with pytest.raises(MspDecodeError, match=f"^decoding {kind.NAME} failed: .* bytes expected, got "):
        kind.decode(payload)


def test_values_that_do_not_fit() -> None:
    with pytest.raises(InvalidArgumentError):
        ApiVersion(0, 1, 256).encode()
    with pytest.raises(InvalidArgumentError):
        FcVariant("Betaflight").encode()


def test_the_identity_of_a_flight_controller() -> None:
    found = {kind: message for kind, _, message in PAYLOADS}
    info = firmware_info(found)
    assert info == FirmwareInfo(
        "BTFL",
        (26, 12, 0),
        (1, 49),
        "SITL",
        "SITL",
        "Nov 22 2026 21:10:03 abc12345",
        "",
        "0302010007060504" + "0b0a0908",
        "2026.12.0-alpha",
    )
    assert firmware_info({}) == FirmwareInfo("")


def test_the_revision_of_a_build_by_firmware() -> None:
    payload = b"Nov 22 202621:10:03abc1234" + b"+@+@"  # the options of Betaflight may look like text
    assert BuildInfo.decode(payload, FirmwareInfo("BTFL")).revision == "abc1234"
    assert BuildInfo.decode(payload, FirmwareInfo("INAV")).revision == "abc1234+@+@"

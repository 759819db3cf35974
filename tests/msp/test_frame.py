from __future__ import annotations

import pytest

from mavstack import InvalidArgumentError
from mavstack.msp import Direction, Frame, FrameVersion
from mavstack.msp.frame import crc8, xor8


@pytest.mark.parametrize(
    ("frame", "encoded"),
    [
        (Frame(1), "244d3c000101"),
        (Frame(1, bytes([0, 1, 46]), Direction.RESPONSE), "244d3e030100012e2d"),
        (Frame(202, direction=Direction.ERROR), "244d2100caca"),
        (Frame(100, version=FrameVersion.V2), "24583c006400000" + "08f"),
        (Frame(100, version=FrameVersion.V2_OVER_V1), "244d3c06ff0064000000" + "8f12"),
        (Frame(0x4242, b"Hello flying world", version=FrameVersion.V2, flags=0xA5), None),
    ],
)
def test_the_bytes_of_each_encoding(frame: Frame, encoded: str | None) -> None:
    # The last one is the example of iNav's description of v2.
    expected = encoded or "24583ca5424212" + "00" + b"Hello flying world".hex() + "82"
    assert frame.encode().hex() == expected


def test_a_payload_above_254_bytes_makes_a_jumbo_frame() -> None:
    frame = Frame(112, bytes(300), Direction.RESPONSE)
    assert frame.encode()[:7] == b"$M>\xffp" + (300).to_bytes(2, "little")
    assert len(frame.encode()) == 308
    assert Frame(112, bytes(254)).encode()[3] == 254
    assert Frame(112, b"a", version=FrameVersion.JUMBO).encode()[3:7] == b"\xffp\x01\x00"


def test_checksums() -> None:
    assert crc8(b"123456789") == 0xBC  # the check value of CRC-8/DVB-S2
    assert xor8(b"") == 0
    assert xor8(b"\x01\x02\x04") == 7


@pytest.mark.parametrize(
    "frame",
    [
        Frame(255),
        Frame(-1),
        Frame(0x10000, version=FrameVersion.V2),
        Frame(1, bytes(4097)),
        Frame(1, flags=1),
        Frame(1, flags=256, version=FrameVersion.V2),
    ],
)
def test_refuses_frames_that_do_not_fit_their_encoding(frame: Frame) -> None:
    with pytest.raises(InvalidArgumentError, match="must "):
        frame.encode()

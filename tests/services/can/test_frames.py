from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.services.can import CanFrame, from_message, to_message
from mavstack.services.can.frames import dronecan_type

FRAMES = st.builds(
    lambda number, data, extended, remote, error, fd: CanFrame(
        number if extended else number & 0x7FF, data if fd else data[:8], extended, remote, error, fd
    ),
    st.integers(0, (1 << 29) - 1),
    st.binary(max_size=64),
    *[st.booleans()] * 4,
)


@given(FRAMES, st.integers(1, 255))
def test_frames_survive_their_message(frame, bus):
    message = to_message(frame, bus, 1, 1)
    assert message.bus == bus - 1
    assert isinstance(message, common.CanfdFrame) is frame.fd
    assert from_message(message) == frame


def test_the_flags_are_those_of_socketcan():
    assert to_message(CanFrame(0x123, b"ab", extended=False), 1).id == 0x123
    assert to_message(CanFrame(1, remote=True), 1).id == 0xC0000001
    assert to_message(CanFrame(1, error=True), 1).id == 0xA0000001


@pytest.mark.parametrize(
    "frame",
    [
        CanFrame(1 << 29),
        CanFrame(0x800, extended=False),
        CanFrame(1, bytes(9)),
        CanFrame(1, bytes(65), fd=True),
    ],
)
def test_frames_that_no_bus_has(frame):
    with pytest.raises(InvalidArgumentError):
        to_message(frame, 1)


def test_a_length_above_the_limit_is_cut():
    assert from_message(common.CanFrame(len=200, id=1, data=bytes(8))).data == bytes(8)


def test_data_types_of_dronecan():
    assert dronecan_type(20 << 24 | 341 << 8 | 42) == 341
    assert dronecan_type(16 << 24 | 1 << 16 | 0x80 | 42) == 1
    assert dronecan_type(20 << 24 | 341 << 8) == 0  # anonymous

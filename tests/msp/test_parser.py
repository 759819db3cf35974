from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.msp import Direction, Frame, FrameParser, FrameVersion
from mavstack.msp.frame import MAX_PAYLOAD
from mavstack.msp.parser import HEADER, MAX_TEXT, State

pytestmark = pytest.mark.properties

RESPONSE = Frame(108, bytes(range(6)), Direction.RESPONSE)


def frames() -> st.SearchStrategy[Frame]:
    def build(command: int, payload: bytes, direction: Direction, version: FrameVersion, flags: int) -> Frame:
        is_v2 = version in (FrameVersion.V2, FrameVersion.V2_OVER_V1)
        frame = Frame(command if is_v2 else command % 255, payload, direction, version, flags if is_v2 else 0)
        long_v1 = version is FrameVersion.V1 and len(payload) > 254
        return replace(frame, version=FrameVersion.JUMBO) if long_v1 else frame

    sizes = st.one_of(st.binary(max_size=20), st.integers(0, 600).map(lambda size: b"$M>\x01" * (size // 4)))
    return st.builds(
        build,
        st.integers(0, 0xFFFF),
        sizes,
        st.sampled_from(Direction),
        st.sampled_from(FrameVersion),
        st.integers(0, 255),
    )


@given(st.lists(frames(), max_size=4), st.lists(st.integers(1, 9), min_size=1))
def test_frames_are_parsed_in_chunks_of_any_size(sent: list[Frame], sizes: list[int]) -> None:
    data = b"".join(frame.encode() for frame in sent)
    parser, received, position, turn = FrameParser(), [], 0, 0
    while position < len(data):
        size = sizes[turn % len(sizes)]
        received += parser.feed(data[position : position + size])
        position, turn = position + size, turn + 1
    assert received == sent
    assert (parser.bad_checksums, parser.oversized, parser.skipped_bytes) == (0, 0, 0)


@given(st.lists(st.one_of(st.binary(max_size=12), frames().map(Frame.encode)), max_size=6), st.data())
def test_the_result_does_not_depend_on_the_chunks(pieces: list[bytes], data: st.DataObject) -> None:
    stream = b"".join(pieces)
    whole, cut = FrameParser(), FrameParser()
    position = data.draw(st.integers(0, len(stream)))
    parsed = cut.feed(stream[:position]) + cut.feed(stream[position:])
    assert parsed == whole.feed(stream)
    assert cut.take_text() == whole.take_text()
    assert (cut.bad_checksums, cut.oversized, cut.state) == (
        whole.bad_checksums,
        whole.oversized,
        whole.state,
    )


@given(st.binary(max_size=60), frames())
def test_a_frame_is_found_behind_any_bytes(garbage: bytes, frame: Frame) -> None:
    parser = FrameParser()
    received = parser.feed(garbage + frame.encode())
    received += parser.resynchronize()
    assert received  # garbage with a `$` may be a frame by chance, with this one in its payload
    assert received == [frame] or b"$" in garbage
    assert parser.state is State.IDLE


def test_text_between_frames_is_kept() -> None:
    parser = FrameParser()
    assert parser.feed(b"boot $1\r\n" + RESPONSE.encode() + b"$$M# ") == [RESPONSE]
    assert parser.take_text() == b"boot $1\r\n$$M# "
    assert parser.take_text() == b""
    assert parser.skipped_bytes == 14
    parser.feed(b"a" * (MAX_TEXT + 5) + b"end")
    assert parser.take_text() == b"a" * (MAX_TEXT - 3) + b"end"


@pytest.mark.parametrize("version", FrameVersion)
def test_a_frame_with_a_damaged_byte_is_counted_and_the_next_one_is_found(version: FrameVersion) -> None:
    damaged = bytearray(replace(RESPONSE, version=version).encode())
    damaged[-3] ^= 1
    parser = FrameParser()
    assert parser.feed(bytes(damaged) + RESPONSE.encode()) == [RESPONSE]
    assert parser.bad_checksums == 1


def test_a_damaged_size_costs_no_frame_behind_it() -> None:
    damaged = bytearray(RESPONSE.encode())
    damaged[3] = 200
    parser = FrameParser()
    assert parser.feed(bytes(damaged) + RESPONSE.encode()) == []  # the parser waits for 200 bytes
    assert parser.resynchronize() == [RESPONSE]
    assert parser.resynchronize() == []


@pytest.mark.parametrize("header", [b"$X>\0\x01\0\x01\x10", b"$M>\xff\x01\x01\x10", b"$M>\xff\xff\x0b\x10"])
def test_a_frame_above_4096_bytes_is_not_awaited(header: bytes) -> None:
    parser = FrameParser()
    assert parser.feed(header + RESPONSE.encode()) == [RESPONSE]
    assert parser.oversized == 1


@pytest.mark.parametrize("version", [FrameVersion.JUMBO, FrameVersion.V2, FrameVersion.V2_OVER_V1])
def test_a_frame_of_4096_bytes(version: FrameVersion) -> None:
    frame = Frame(70, bytes(MAX_PAYLOAD), Direction.RESPONSE, version)
    assert FrameParser().feed(frame.encode()) == [frame]


@pytest.mark.parametrize("inner", [b"", b"\0\1\0\0\0", b"\0\1\0\1\0\x33", b"\0\1\0\0\0\x01"])
def test_v2_over_v1_with_a_wrong_inner_frame(inner: bytes) -> None:
    body = bytes([len(inner), 255]) + inner
    checksum = 0
    for byte in body:
        checksum ^= byte
    parser = FrameParser()
    assert parser.feed(b"$M>" + body + bytes([checksum])) == []
    assert parser.bad_checksums == 1


def test_in_the_cli_all_bytes_are_text() -> None:
    parser = FrameParser()
    parser.feed(b"$M")
    parser.enter_cli()
    assert parser.state is State.CLI
    assert parser.feed(RESPONSE.encode()) == []
    assert parser.resynchronize() == []
    assert parser.take_text() == b"$M" + RESPONSE.encode()
    parser.leave_cli()
    assert parser.feed(RESPONSE.encode()) == [RESPONSE]


def test_the_table_has_each_state_of_a_header() -> None:
    outside = {State.IDLE, State.PAYLOAD_V1, State.CHECKSUM_V1, State.PAYLOAD_V2_OVER_V1}
    outside |= {State.PAYLOAD_V2, State.CHECKSUM_V2, State.CLI}
    assert set(HEADER) == set(State) - outside
    assert len(State) == 19

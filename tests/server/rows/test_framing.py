from __future__ import annotations

import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.server.rows.frame_decoder import parse_decoder
from mavstack.server.rows.framing import MAX_DATAGRAM, MAX_FRAME, decode_cobs, make_framer

STREAMS = {
    "delimiter": {"framing": {"kind": "delimiter", "delimiter": "0d0a"}},
    "cobs": {"framing": {"kind": "cobs"}, "checksum": {"kind": "sum8"}},
    "fixed": {"framing": {"kind": "fixed", "marker": "aa", "size": 4}, "checksum": {"kind": "xor8"}},
    "length": {
        "framing": {"kind": "length", "marker": "aa55", "length": {"offset": 2, "type": "uint8"}, "add": 1},
        "checksum": {"kind": "sum8"},
    },
}
LENGTH = {"offset": 1, "type": "uint16"}
#: Bytes that markers, delimiters and small lengths are made of.
PIECES = st.lists(
    st.sampled_from([b"\0", b"\x01", b"\x05", b"\x0d", b"\x0a", b"\xaa", b"\x55", b"\xff" * 20]), max_size=300
)


def framer(declaration: dict):
    decoder = parse_decoder(declaration)
    return make_framer(decoder.framing, decoder.checksum)


def encode_cobs(data: bytes) -> bytes:
    found = bytearray()
    for block in data.split(b"\0"):
        rest = block
        while len(rest) >= 254:
            found += b"\xff" + rest[:254]
            rest = rest[254:]
        found += bytes([len(rest) + 1]) + rest
    return bytes(found)


@pytest.mark.parametrize("kind", STREAMS)
@given(pieces=PIECES, cuts=st.lists(st.integers(1, 50), max_size=40))
def test_frames_do_not_depend_on_where_the_bytes_are_cut(kind: str, pieces: list, cuts: list) -> None:
    data = b"".join(pieces)
    whole, parts = framer(STREAMS[kind]), framer(STREAMS[kind])
    expected, found, at = whole.feed(data), [], 0
    for cut in cuts:
        found += parts.feed(data[at : at + cut])
        at += cut
    found += parts.feed(data[at:])
    assert (found, parts.refused) == (expected, whole.refused)


@given(st.binary(min_size=1, max_size=700))
def test_cobs_is_decoded(data: bytes) -> None:
    encoded = encode_cobs(data)
    assert b"\0" not in encoded
    assert decode_cobs(encoded) == data


@pytest.mark.parametrize("text", ["00", "0501", "030100", "ff01"])
def test_malformed_cobs(text: str) -> None:
    assert decode_cobs(bytes.fromhex(text)) is None


@given(st.lists(st.binary(max_size=40), max_size=20), st.binary(max_size=8))
def test_frames_with_a_marker_are_found_after_noise(payloads: list, noise: bytes) -> None:
    clean = noise.replace(b"\xaa", b"")
    stream = b""
    for payload in payloads:
        frame = b"\xaa\x55" + bytes([len(payload) + 3]) + payload
        stream += clean + frame + bytes([sum(frame) & 0xFF])
    found = framer(STREAMS["length"]).feed(stream)
    assert [frame[3:-1] for frame in found] == payloads


def test_frames_are_bounded() -> None:
    lines = framer(STREAMS["delimiter"])
    assert lines.feed(b"x" * 100_000 + b"\r\n" + b"y" * MAX_FRAME + b"\r\n") == [b"y" * MAX_FRAME]
    assert lines.refused == 1
    parts = [part for _ in range(10) for part in lines.feed(b"x" * 1000)]
    assert (parts, lines.feed(b"\r\nz\r\n"), lines.refused) == ([], [b"z"], 2)
    datagrams = framer({})
    assert datagrams.feed(bytes(MAX_DATAGRAM + 1)) == []
    assert datagrams.refused == 1
    sized = framer({"framing": {"kind": "length", "marker": "aa", "length": {"offset": 1, "type": "uint16"}}})
    assert sized.feed(b"\xaa" + struct.pack("<H", MAX_FRAME + 1) + b"\xaa\x04\x00\x07") == [
        b"\xaa\x04\x00\x07"
    ]


def test_a_stream_of_false_markers_costs_a_bounded_number_of_checks() -> None:
    checked = 0

    class Wrong:
        def fits(self, frame: bytes) -> bool:
            nonlocal checked
            checked += len(frame)
            return False

    decoder = parse_decoder({"framing": {"kind": "length", "marker": "aa", "length": LENGTH}})
    stream = b"\xaa\xff\x0f" * 40_000
    make_framer(decoder.framing, Wrong()).feed(stream)
    assert checked < 6 * len(stream)

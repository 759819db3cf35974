from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from mavstack.security.sealed.cobs import MAX_DATAGRAM, Decoder, encode

runs = st.integers(250, 520).map(lambda size: b"\1" * size)
datagrams = st.lists(st.one_of(st.binary(min_size=1, max_size=600), runs), max_size=8)


@given(datagrams, st.lists(st.integers(1, 300), min_size=1))
def test_datagrams_over_a_stream_in_chunks_of_any_size(datagrams, sizes):
    stream = b"".join(map(encode, datagrams))
    decoder, received, position, number = Decoder(), [], 0, 0
    while position < len(stream):
        size = sizes[number % len(sizes)]
        received += decoder.feed(stream[position : position + size])
        position, number = position + size, number + 1
    assert received == datagrams
    assert decoder.junk == 0


@given(st.binary(min_size=1, max_size=1000))
def test_the_overhead_and_the_zero_bytes(datagram):
    stream = encode(datagram)
    assert stream.index(0) == len(stream) - 1
    assert len(stream) <= len(datagram) + 2 + len(datagram) // 254


@given(st.binary(max_size=300))
def test_after_junk_the_next_datagrams_are_found(junk):
    assert Decoder().feed(junk + b"\0" + encode(b"one") + encode(b"two"))[-2:] == [b"one", b"two"]


def test_junk_without_an_end_is_bounded():
    decoder = Decoder()
    for _ in range(200):
        decoder.feed(b"\1" * 1000)
    assert decoder.junk >= 2 * MAX_DATAGRAM
    assert len(decoder._rest) <= MAX_DATAGRAM * 1.1
    assert decoder.feed(b"\0" + encode(b"next"))[-1] == b"next"

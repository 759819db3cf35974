"""Frames of pcap and pcapng files."""

from __future__ import annotations

from struct import pack

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.logs.packets.pcap.frames import CaptureDamage, Frame, read_frames
from tests.logs.packets.pcap.captures import START, block, enhanced, interface, pcap, pcapng, section

FRAMES = [b"one", b"", b"three three"]
EXPECTED = [Frame(START + 1000 * number, 101, frame) for number, frame in enumerate(FRAMES)]
each_order = pytest.mark.parametrize("order", ["<", ">"])


def read(data):
    damage = CaptureDamage()
    return list(read_frames(data, damage)), damage


@each_order
@pytest.mark.parametrize("nanoseconds", [False, True])
def test_pcap(order, nanoseconds):
    assert read(pcap(FRAMES, order=order, nanoseconds=nanoseconds)) == (EXPECTED, CaptureDamage())


@each_order
def test_pcapng(order):
    assert read(pcapng(FRAMES, order=order)) == (EXPECTED, CaptureDamage())


def test_sections_of_both_byte_orders():
    assert read(pcapng(FRAMES) + pcapng(FRAMES, order=">"))[0] == EXPECTED * 2


def test_resolution_and_offset_of_times():
    seconds = interface(1, options=pack("<HHBxxx", 9, 1, 0) + pack("<HHq", 14, 8, 1000))
    binary = interface(113, options=pack("<HHBxxx", 9, 1, 0x80 | 10))
    data = section() + seconds + binary + enhanced(b"a", 5) + enhanced(b"b", 1536, number=1)
    assert read(data)[0] == [Frame(1005_000_000, 1, b"a"), Frame(1_500_000, 113, b"b")]


def test_blocks_of_other_kinds():
    old = block(2, pack("<2H4I", 0, 0, START >> 32, START & 0xFFFF_FFFF, 3, 3) + b"old")
    simple = block(3, pack("<I", 6) + b"simple")
    data = section() + interface() + block(5, bytes(12)) + block(77, b"later") + old + simple
    assert read(data) == ([Frame(START, 101, b"old"), Frame(None, 101, b"simple")], CaptureDamage())


@pytest.mark.parametrize("make", [pcap, pcapng])
def test_truncated_files(make):
    data = make(FRAMES)
    frames, damage = read(data[:-1])
    assert frames == EXPECTED[:2]
    assert damage.bad_bytes == 0
    assert damage.truncated_bytes > 11


@pytest.mark.parametrize("make", [pcap, pcapng])
def test_junk_between_records(make):
    whole = make(FRAMES)
    cut = len(make(FRAMES[:1]))
    frames, damage = read(whole[:cut] + b"\xff" * 33 + whole[cut:])
    assert (frames, damage) == (EXPECTED, CaptureDamage(bad_bytes=33))


def test_a_clock_that_is_set_meanwhile():
    frames, damage = read(pcap(FRAMES, start=0) + pcap(FRAMES)[24:])
    assert ([frame.data for frame in frames], damage) == (FRAMES * 2, CaptureDamage())


def test_a_frame_of_an_unknown_interface():
    frames, damage = read(section() + enhanced(b"lost", 0) + interface())
    assert (frames, damage.bad_bytes) == ([], 36)


@given(st.sampled_from([pcap(FRAMES), pcapng(FRAMES), pcap([])]), st.binary(max_size=80), st.integers(0, 200))
def test_any_bytes_are_read(start, junk, place):
    frames, damage = read(start[:place] + junk + start[place:])
    assert damage.bad_bytes + damage.truncated_bytes + sum(len(frame.data) for frame in frames) <= len(
        start
    ) + len(junk)

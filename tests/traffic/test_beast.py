from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.traffic import BeastReader
from mavstack.traffic.beast import decode_position, mode_s_remainder

#: Frames of "The 1090 Megahertz Riddle".
NAME = "8D4840D6202CC371C32CE0576098"
EVEN, ODD = "8D40621D58C382D690C8AC2863A7", "8D40621D58C386435CC412692AD6"
VELOCITY = "8D485020994409940838175B284F"


def beast(*frames: str) -> bytes:
    packets = (b"\x001234\x1a" + b"\x20" + bytes.fromhex(frame) for frame in frames)
    return b"".join(b"\x1a3" + packet.replace(b"\x1a", b"\x1a\x1a") for packet in packets)


@given(st.lists(st.integers(1, 30)))
def test_known_frames_in_any_cut(cuts):
    reader, data, reports = BeastReader(), beast(NAME, ODD, EVEN, VELOCITY), []
    for size in [*cuts, len(data)]:
        reports += reader.feed(data[:size], 100.0)
        data = data[size:]
    name, odd, even, velocity = reports
    assert (name.address, name.callsign) == (0x4840D6, "KLM1023")
    assert (odd.latitude, odd.altitude) == (None, pytest.approx(38000 * 0.3048))
    assert (even.latitude, even.longitude) == (
        pytest.approx(52.25720, abs=1e-5),
        pytest.approx(3.91937, abs=1e-5),
    )
    assert (velocity.course, velocity.speed) == (
        pytest.approx(182.88, abs=0.01),
        pytest.approx(159.2 * 1852 / 3600, abs=0.02),
    )
    assert velocity.climb == pytest.approx(-832 * 0.3048 / 60)
    assert reader.bad == 0


def test_halves_that_are_too_old_give_no_position():
    reader = BeastReader()
    reader.feed(beast(ODD), 100.0)
    (report,) = reader.feed(beast(EVEN), 111.0)
    assert report.latitude is None


def test_damaged_frames_are_counted():
    reader = BeastReader()
    assert reader.feed(beast(NAME[:-1] + "9")) == []
    assert reader.bad == 1
    assert mode_s_remainder(bytes.fromhex(NAME)) == 0


def test_a_frame_that_ends_early_hides_no_other():
    reader = BeastReader()
    reports = reader.feed(b"junk" + beast(NAME)[:15] + beast(VELOCITY))
    assert [report.address for report in reports] == [0x485020]


@given(st.lists(st.binary(max_size=80)))
def test_any_bytes_are_accepted(chunks):
    reader = BeastReader()
    for time, chunk in enumerate(chunks):
        reader.feed(b"\x1a3" + chunk, float(time))


WORDS = st.integers(0, (1 << 17) - 1)


@given(WORDS, WORDS, WORDS, WORDS, st.booleans())
def test_any_pair_is_a_place_on_earth_or_none(a, b, c, d, odd):
    place = decode_position((a, b), (c, d), newest_is_odd=odd)
    assert place is None or (abs(place[0]) <= 90 and -180 <= place[1] <= 180)

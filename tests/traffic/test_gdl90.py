from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.traffic import Gdl90Reader
from mavstack.traffic.gdl90 import gdl90_crc, gdl90_frame

#: The examples of the specification: a heartbeat, and a traffic report of N825V.
HEARTBEAT = bytes.fromhex("7e008141dbd00802b38b7e")
TRAFFIC = bytes.fromhex("1400ab4549 1fef15 a88978 0f09 a9 07b001 20 01 4e38323556202020 00".replace(" ", ""))


def test_the_examples_of_the_specification():
    assert gdl90_crc(HEARTBEAT[1:-3]) == 0x8BB3
    reader = Gdl90Reader()
    assert reader.feed(HEARTBEAT) == []
    (report,) = reader.feed(gdl90_frame(TRAFFIC))
    assert (report.address, report.callsign) == (0xAB4549, "N825V")
    assert report.latitude == pytest.approx(44.90708, abs=3e-5)
    assert report.longitude == pytest.approx(-122.99488, abs=3e-5)
    assert report.altitude == pytest.approx(5000 * 0.3048)
    assert report.speed == pytest.approx(123 * 1852 / 3600)
    assert report.climb == pytest.approx(64 * 0.3048 / 60)
    assert report.course == 45
    assert reader.bad == 0


@given(st.binary(max_size=200), st.lists(st.integers(1, 20)))
def test_frames_behind_junk_in_any_cut(junk, cuts):
    reader, reports = Gdl90Reader(), []
    data = junk + gdl90_frame(TRAFFIC)
    for size in [*cuts, len(data)]:
        reports += reader.feed(data[:size])
        data = data[size:]
    assert reports[-1].callsign == "N825V"


@given(st.binary(max_size=60))
def test_any_content_is_accepted(content):
    Gdl90Reader().feed(gdl90_frame(content) + gdl90_frame(bytes((20,)) + content[:27].ljust(27, b"\x7e")))

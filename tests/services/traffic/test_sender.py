from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from mavstack.dialects import common
from mavstack.services.traffic import TrafficSender, to_message
from mavstack.traffic import Aircraft
from tests.services.network import GROUND, START
from tests.services.single_service import sent_by

NUMBERS = st.none() | st.floats()
FULL = Aircraft(
    0x4CA2D6, START - 2, START, "RYR1427", 47.39, 8.54, 1000.0, False, 359.999, 231.5, -3.25, 7700
)


def test_all_values():
    message = to_message(FULL, START)
    assert (message.lat, message.lon, message.altitude, message.heading) == (
        473900000,
        85400000,
        1_000_000,
        35_999,
    )
    assert (message.hor_velocity, message.ver_velocity, message.callsign) == (23150, -325, "RYR1427")
    assert (message.tslc, message.squawk, int(message.flags)) == (
        2,
        7700,
        1 | 2 | 4 | 8 | 16 | 32 | 128 | 256,
    )


@given(NUMBERS, NUMBERS, NUMBERS, NUMBERS, st.booleans())
def test_any_value_fits(altitude, course, speed, climb, geometric):
    aircraft = Aircraft(1, 0.0, 0.0, None, None, None, altitude, geometric, course, speed, climb)
    message = to_message(aircraft, START)
    assert message.tslc == 255
    assert not int(message.flags) & common.AdsbFlags.VALID_COORDS


def test_newer_aircraft_replace_waiting_ones():
    sender = TrafficSender(GROUND)
    sender.show([FULL] * 3, START)
    assert sent_by(sender, START, lambda *_: False) == []
    sender.show([FULL], START)
    assert len(sent_by(sender)) == 1
    assert (sender.sent, sender.late) == (1, 3)

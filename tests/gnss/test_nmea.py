from __future__ import annotations

from datetime import UTC, datetime

from hypothesis import given
from hypothesis import strategies as st

from mavstack.gnss.nmea import Fix, NmeaFramer, format_gga, format_rmc, sentence

NOON = 1_700_049_600.25  # 2023-11-15 12:00:00.25 UTC
PLACE = Fix(NOON, 47.3977, -8.545, 488.0, fix_type=6, satellites=14, hdop=0.6, separation=47.0)
FIXES = st.builds(
    Fix,
    st.floats(0, 3e9),
    st.floats(-90, 90),
    st.floats(-180, 180),
    st.floats(-500, 20_000),
    st.integers(0, 20),
    st.integers(0, 255),
    st.floats(0, 1000),
    st.just(0.0),
)


def test_gga_and_rmc():
    gga = format_gga(PLACE)
    assert gga.startswith(b"$GPGGA,120000.25,4723.8620000,N,00832.7000000,W,4,14,0.6,488.00,M,47.0,M,,*")
    rmc = format_rmc(PLACE, 10.0, 93.25)
    assert rmc.startswith(b"$GPRMC,120000.25,A,4723.8620000,N,00832.7000000,W,19.44,93.2,151123,,,A*")
    assert b",V," in format_rmc(PLACE._replace(fix_type=1))


@given(FIXES)
def test_pynmeagps_reads_the_position(fix):
    from pynmeagps import NMEAReader

    read = NMEAReader.parse(format_gga(fix))
    assert abs(read.lat - fix.latitude) < 1e-7
    assert abs(read.lon - fix.longitude) < 1e-7
    moving = NMEAReader.parse(format_rmc(fix, 3.0, 359.99))
    assert abs(moving.lat - fix.latitude) < 1e-7
    assert moving.date == datetime.fromtimestamp(fix.time, UTC).date()


@given(st.lists(st.binary(max_size=60)), FIXES)
def test_any_bytes_are_accepted_and_a_sentence_is_found_behind_them(junk, fix):
    framer = NmeaFramer()
    for data in junk:
        framer.feed(data)
    line = format_gga(fix)
    assert framer.feed(b"\r\n" + line)[-1:] == [line[1:-5].decode()]


def test_bad_lines_are_counted():
    framer = NmeaFramer()
    assert framer.feed(b"$GPGGA,1*00\r\nhello\n$GPTXT*zz\n" + sentence("GPTXT,ok")) == ["GPTXT,ok"]
    assert framer.bad_lines == 3

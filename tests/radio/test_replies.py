"""Parsers of replies: lists, numbers, reports; anything else is ignored."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.radio import StoredParameter, parse_number, parse_parameters, parse_rssi, signal_dbm

REPORT = "L/R RSSI: 222/216  L/R noise: 30/29 pkts: 12345  txe=1 rxe=2 stx=3 srx=4 ecc=5/6 temp=-7 dco=8"


def test_lists_of_several_firmwares():
    lines = [
        "ATI5",
        "S0: FORMAT=26",
        " S3: NETID=25",
        "[1] S4:TXPOWER(N)=20 dBm",
        "S1: SERIAL",
        "junk",
        "S2: X=-1",
    ]
    assert parse_parameters(lines) == {
        "FORMAT": StoredParameter(0, 26),
        "NETID": StoredParameter(3, 25),
        "TXPOWER": StoredParameter(4, 20),
    }
    assert parse_parameters(["S8: MIN_FREQ=9999999999"]) == {}


def test_numbers():
    assert (parse_number("57"), parse_number("[2] 145"), parse_number("1.9"), parse_number("")) == (
        57,
        145,
        None,
        None,
    )


def test_reports_with_bytes_around_them():
    report = parse_rssi("\ufffd\ufffd" + REPORT)
    assert (report.local_rssi, report.remote_noise, report.packets) == (222, 29, 12345)
    assert (report.transmit_errors, report.corrected_packets, report.temperature) == (1, 6, -7)
    assert report.fade_margin == pytest.approx(187 / 1.9)
    assert parse_rssi(REPORT.partition(" temp")[0]).temperature is None
    assert parse_rssi("L/R RSSI: 1/2") is None


def test_signal_in_dbm():
    assert signal_dbm(190) == pytest.approx(-27)


@pytest.mark.properties
@given(st.lists(st.text(max_size=60), max_size=5))
def test_any_line_is_read_without_an_error(lines):
    for each in parse_parameters(lines).values():
        assert 0 <= each.value < 1 << 32
    for line in lines:
        parse_number(line)
        parse_rssi(line)

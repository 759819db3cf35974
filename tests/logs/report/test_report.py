"""The report of a log: a page without other files, and its facts."""

from __future__ import annotations

import json
import re
import sys
from html.parser import HTMLParser

import numpy as np
import pytest

from mavstack import open_log
from mavstack.dialects import common
from mavstack.logs.report import make_report
from tests.logs.files import START, encoded, stamped
from tests.logs.flights import flight_tlog

VOID = {"meta", "br"}


class Page(HTMLParser):
    """A page whose elements are counted, and must be closed in their order."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.elements: list[tuple[str, dict[str, str | None]]] = []
        self.text = ""
        self.feed(html)
        assert self.open == []

    def handle_starttag(self, tag, attributes):
        self.elements.append((tag, dict(attributes)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attributes):
        self.elements.append((tag, dict(attributes)))

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.text += data

    def lines(self) -> list[list[tuple[float, float]]]:
        """Return the points of each line of each chart."""
        return [
            [tuple(map(float, point.split(","))) for point in (attributes["points"] or "").split()]
            for tag, attributes in self.elements
            if tag == "polyline"
        ]


def test_the_page_has_the_charts_of_the_flight(flight):
    page = Page(make_report(flight).html)
    for title in ("Findings", "Track", "Attitude", "Altitude"):
        assert title in page.text
    lines = page.lines()
    assert len(lines) >= 4
    assert all(len(line) > 1 and len(set(line)) > 1 for line in lines), "no line is empty or a single point"
    assert "second 9" in page.text
    assert "STABILIZE" in page.text


def test_the_page_needs_no_other_file(flight):
    html = make_report(flight).html
    assert not re.search(r"(src|href|url)\s*[=(](?!#)", html)
    assert "@media (prefers-color-scheme:dark)" in html
    assert 'name="viewport"' in html


def test_information_of_the_log(flight):
    page = Page(make_report(flight).html)
    subtitle, _, rest = page.text.partition("Findings")
    assert "QUADROTOR · ARDUPILOTMEGA" in subtitle
    assert "Information (" in rest
    assert all(value in rest for value in flight.info.values())


@pytest.mark.parametrize(
    ("seconds", "text"), [(59, "59 s"), (429, "7 min 9 s"), (3599.6, "1 h 0 min"), (5400, "1 h 30 min")]
)
def test_the_length_of_a_flight(tmp_path, seconds, text):
    path = tmp_path / "long.tlog"
    beats = [common.Heartbeat(type=2, autopilot=3, base_mode=129)] * 2
    path.write_bytes(stamped(encoded(beats), step=round(seconds * 1e6)))
    page = Page(make_report(open_log(path, "common")).html)
    assert f"0.0 MB · {text} ·" in page.text


def test_rates_and_gaps_of_messages(tmp_path):
    path = tmp_path / "gap.tlog"
    packets = encoded([common.Attitude()])
    path.write_bytes(b"".join(stamped(packets, START + second * 10**6) for second in (*range(20), 30)))
    html = make_report(open_log(path, "common")).html
    assert '<td>ATTITUDE</td><td class="n">21</td><td class="n">0.7</td><td class="n">11.0 s</td>' in html


def test_a_text_of_the_vehicle_is_no_markup(tmp_path):
    path = tmp_path / "x<script>.tlog"
    path.write_bytes(
        flight_tlog() + stamped(encoded([common.Statustext(severity=2, text="<script>alert(1)</script>")]))
    )
    html = make_report(open_log(path, "common")).html
    assert "<script>alert" not in html
    assert "&lt;script&gt;alert(1)" in html


def test_the_facts(flight):
    data = json.loads(json.dumps(make_report(flight).data))
    assert data["file"] == "flight.tlog"
    assert data["duration_s"] == pytest.approx(9.9)
    first, second = data["vehicles"]
    assert (first["system"], second["system"]) == (1, 2)
    assert first["facts"]["armed_s"] == pytest.approx(6.0)
    assert first["facts"]["takeoffs"] == 0, "it was in the air when it was armed"
    assert first["facts"]["distance_m"] == pytest.approx(100.1, abs=0.1)
    assert first["facts"]["max_altitude_m"] == 7.0
    assert [mode["mode"] for mode in first["modes"]] == ["STABILIZE", "LAND"]
    assert first["armed"] == [{"start_s": 2.0, "end_s": 8.0}]


def test_takeoffs_and_used_charge(tmp_path):
    messages = []
    for second in range(60):
        height = 5.0 if second % 20 >= 10 else 0.0
        messages += [
            common.Heartbeat(type=2, autopilot=3, base_mode=129),
            common.GlobalPositionInt(relative_alt=round(height * 1000), lat=1, lon=1),
            common.SysStatus(current_battery=3600, voltage_battery=12000),
        ]
    path = tmp_path / "hops.tlog"
    path.write_bytes(stamped(encoded(messages), step=333_333))
    facts = make_report(open_log(path, "common")).data["vehicles"][0]["facts"]
    assert facts["takeoffs"] == 3
    assert facts["used_mah"] == pytest.approx(36 * 59 / 3.6, rel=0.01)
    assert facts["max_current_a"] == 36


def test_a_sensor_without_calibration_measured_no_highest_current(tmp_path):
    messages = [common.Heartbeat(type=12, autopilot=3, base_mode=129)]
    messages += [common.BatteryStatus(current_battery=-1120, voltages=[12000]) for _ in range(20)]
    messages += [common.SysStatus(current_battery=-1120, voltage_battery=12000) for _ in range(20)]
    path = tmp_path / "sub.tlog"
    path.write_bytes(stamped(encoded(messages), step=333_333))
    facts = make_report(open_log(path, "common")).data["vehicles"][0]["facts"]
    assert "min_voltage_v" in facts
    assert not {"max_current_a", "used_mah"} & facts.keys()


def test_a_log_without_a_vehicle_has_a_report(tmp_path):
    path = tmp_path / "none.tlog"
    path.write_bytes(b"nothing to see here")
    report = make_report(open_log(path, "common"))
    assert "19 bad bytes" in Page(report.html).text
    assert report.data["vehicles"][0]["findings"] == []


def test_a_stream_without_times_has_a_report(tmp_path):
    path = tmp_path / "stream.raw"
    path.write_bytes(b"".join(encoded([common.Heartbeat(type=2, autopilot=3)] * 5)))
    report = make_report(open_log(path, timestamped=False))
    assert report.data["vehicles"][0]["vehicle_type"] == "QUADROTOR"
    assert "HEARTBEAT" in report.html


def test_values_that_are_no_numbers_are_left_out(tmp_path):
    messages = [common.Attitude(roll=value) for value in (0.1, float("nan"), 0.3, float("inf"), 0.2)]
    path = tmp_path / "nan.tlog"
    path.write_bytes(stamped(encoded([common.Heartbeat(type=2, autopilot=3), *messages])))
    page = Page(make_report(open_log(path, "common")).html)
    assert np.isfinite([point for line in page.lines() for pair in line for point in pair]).all()


def test_thousands_of_changes_cost_little(tmp_path):
    def calls(count):
        """Return the number of calls of a report on a flight with changes of the mode and of a parameter."""
        messages = [
            message
            for number in range(count)
            for message in (
                common.Heartbeat(type=2, autopilot=3, base_mode=0x81, custom_mode=number % 2),
                common.ParamValue(param_id="GAIN", param_value=number, param_type=9, param_count=1),
                common.Attitude(time_boot_ms=number * 1000),
            )
        ]
        path = tmp_path / f"{count}.tlog"
        path.write_bytes(stamped(encoded(messages)))
        log, counted = open_log(path, "common"), 0

        def count_call(frame, event, argument):
            nonlocal counted
            counted += event in {"call", "c_call"}

        sys.setprofile(count_call)
        try:
            make_report(log)
        finally:
            sys.setprofile(None)
        return counted

    assert calls(1500) - calls(500) < 80 * 1000, "calls for 1000 changes of each kind"


def test_a_gap_in_the_log_is_no_consumption(tmp_path):
    messages = [
        common.Heartbeat(type=2, autopilot=3, base_mode=129),
        *[common.SysStatus(current_battery=1000)] * 3,
    ]
    path = tmp_path / "gap.tlog"
    path.write_bytes(stamped(encoded(messages), step=100_000_000))
    facts = make_report(open_log(path, "common")).data["vehicles"][0]["facts"]
    assert facts["used_mah"] == pytest.approx(10 * 2 * 5 / 3.6, abs=0.01), "10 A, of each gap 5 s"

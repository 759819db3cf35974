"""The charts of the topics."""

from __future__ import annotations

import numpy as np
import pytest

from mavstack import open_log
from mavstack.dialects import common
from mavstack.logs.analysis import SIGNALS, flights
from mavstack.logs.report.panels import PANELS, charts_of
from tests.logs.files import encoded, stamped
from tests.logs.memory_log import MemoryLog


def test_every_line_is_a_signal():
    names = {name for panels in PANELS.values() for panel in panels for name in panel.signals}
    assert names <= SIGNALS.keys()
    assert {"attitude", "vibration", "power", "gps", "link"} <= PANELS.keys()
    titles = [panel.title for panels in PANELS.values() for panel in panels]
    assert len(titles) == len(set(titles))


def test_signal_and_noise_of_a_radio_are_one_chart_in_dbm(tmp_path):
    statuses = [common.RadioStatus(rssi=190, remrssi=171, noise=38, remnoise=57) for _ in range(3)]
    path = tmp_path / "radio.tlog"
    path.write_bytes(stamped(encoded(statuses)))
    (flight,) = flights(open_log(path, "common"))
    (chart,) = charts_of(flight, "link")
    assert chart.unit == "dBm"
    assert [line.label for line in chart.lines] == [
        "radio RSSI, local",
        "radio RSSI, remote",
        "radio noise, local",
        "radio noise, remote",
    ]
    assert [line.ys[0] for line in chart.lines] == pytest.approx([-27, -37, -107, -97])


def test_fast_accelerations_give_a_spectrum():
    times = np.arange(2048) / 400
    shaken = np.sin(2 * np.pi * 100 * times)
    columns = {"TimeUS": (times * 1e6).round(), "AccX": shaken, "AccY": shaken, "AccZ": shaken}
    (flight,) = flights(MemoryLog({"ACC": columns}))
    (chart,) = charts_of(flight, "vibration")
    assert (chart.title, chart.axis) == ("Spectrum of the accelerations (ACC, 400 Hz)", "Hz")
    assert [line.xs[line.ys.argmax()] for line in chart.lines] == pytest.approx([100] * 3, abs=1)


def test_outputs_that_are_not_connected_are_left_out(tmp_path):
    path = tmp_path / "outputs.tlog"
    path.write_bytes(stamped(encoded([common.ServoOutputRaw(servo1_raw=1100, servo3_raw=1500)] * 3)))
    (flight,) = flights(open_log(path, "common"))
    (chart,) = charts_of(flight, "outputs")
    assert [line.label for line in chart.lines] == ["output 1", "output 3"]


def test_a_topic_without_values_has_no_chart(tmp_path):
    path = tmp_path / "beat.tlog"
    path.write_bytes(stamped(encoded([common.Heartbeat(type=2, autopilot=3)])))
    (flight,) = flights(open_log(path, "common"))
    assert not [chart for topic in PANELS for chart in charts_of(flight, topic)]

"""Signals under one name, whatever the format calls them."""

from __future__ import annotations

import numpy as np
import pytest

from mavstack import open_log
from mavstack.dialects import common
from mavstack.logs.analysis import SIGNALS, flights, read_signal
from tests.logs.files import encoded, stamped
from tests.logs.memory_log import MemoryLog
from tests.logs.ulog.ulog_files import UlogBuilder


def quaternion(roll, pitch, yaw):
    """Return a quaternion of angles in degrees, by its half angles."""
    angles = np.radians([roll, pitch, yaw]) / 2
    (cr, cp, cy), (sr, sp, sy) = np.cos(angles), np.sin(angles)
    return (
        cr * cp * cy + sr * sp * sy,
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
    )


def test_the_attitude_of_a_ulog_is_a_quaternion(tmp_path):
    builder = UlogBuilder()
    builder.flags()
    builder.formats("vehicle_attitude:uint64_t timestamp;float[4] q;")
    builder.subscribe(0, "vehicle_attitude")
    angles = [(10.0, 20.0, 30.0), (-170.0, -80.0, 170.0), (0.0, 0.0, -90.0)]
    for number, each in enumerate(angles):
        builder.record(0, "Q4f", 1_000_000 * (number + 1), *quaternion(*each))
    path = tmp_path / "attitude.ulg"
    path.write_bytes(bytes(builder.data))
    (flight,) = flights(open_log(path))
    for index, name in enumerate(("roll", "pitch", "yaw")):
        signal = flight.signal(name)
        assert signal.source == "vehicle_attitude.q"
        assert signal.values == pytest.approx([each[index] for each in angles], abs=1e-4)
        assert np.diff(signal.times) == pytest.approx(1.0)


def test_values_have_the_unit_of_the_signal(tmp_path):
    messages = [
        common.Attitude(roll=np.pi / 2),
        common.SysStatus(voltage_battery=12_600, current_battery=-1, battery_remaining=80),
        common.GpsRawInt(eph=121, fix_type=3),
    ]
    path = tmp_path / "x.tlog"
    path.write_bytes(stamped(encoded(messages)))
    log = open_log(path, "common")
    assert read_signal(log, "roll").values.tolist() == pytest.approx([90.0])
    assert read_signal(log, "voltage").values.tolist() == pytest.approx([12.6])
    assert read_signal(log, "hdop").values.tolist() == pytest.approx([1.21])
    assert read_signal(log, "current") is None, "the current is marked as unknown"
    assert read_signal(log, "roll", system=7) is None


def test_a_charge_that_the_vehicle_does_not_know_is_no_value():
    log = MemoryLog({"BAT": {"TimeUS": [1, 2, 3], "RemPct": [255, 80, 255]}})
    assert read_signal(log, "remaining").values.tolist() == [80.0]


def test_a_load_that_no_processor_has_is_no_value():
    log = MemoryLog({"PM": {"TimeUS": [1, 2, 3], "Load": [470, 25344, 480]}})
    assert read_signal(log, "cpu_load").values.tolist() == pytest.approx([47.0, 48.0])


def test_every_signal_has_a_title_and_a_source():
    assert all(each.title and each.sources for each in SIGNALS.values())


def test_outputs_are_those_of_the_first_port(tmp_path):
    outputs = [
        common.ServoOutputRaw(port=number % 2, servo1_raw=1900 if number % 2 else 1500)
        for number in range(10)
    ]
    path = tmp_path / "ports.tlog"
    path.write_bytes(stamped(encoded(outputs)))
    assert read_signal(open_log(path, "common"), "output_1").values.tolist() == [1500.0] * 5


def test_the_precision_before_the_first_fix_is_unknown(tmp_path):
    path = tmp_path / "fix.tlog"
    path.write_bytes(stamped(encoded([common.GpsRawInt(eph=eph) for eph in (9999, 9999, 85)])))
    assert read_signal(open_log(path, "common"), "hdop").values.tolist() == pytest.approx([0.85])

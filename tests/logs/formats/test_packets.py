"""The formats of packets pass the conformance tests of logs."""

from __future__ import annotations

import numpy as np
import pytest

import mavstack
from mavstack.dialects import common
from tests.logs.conformance import LogConformance
from tests.logs.files import encoded, stamped

MESSAGES = [
    message
    for number in range(60)
    for message in (
        common.Attitude(time_boot_ms=5000 + number * 100, roll=number / 8),
        common.BatteryStatus(id=number % 2, voltages=[number] * 10),
        *([common.Heartbeat(type=2, autopilot=3)] if number % 10 == 0 else []),
    )
]


class TestTlog(LogConformance):
    format = "tlog"

    def write(self, folder):
        path = folder / "flight"
        path.write_bytes(stamped(encoded(MESSAGES), step=50_000))
        return path


class TestRaw(LogConformance):
    format = "raw"
    has_start = False

    def write(self, folder):
        path = folder / "flight"
        path.write_bytes(b"".join(encoded(MESSAGES)))
        return path

    @pytest.mark.skip(reason="a raw stream has no times")
    def test_selecting_times(self):
        pass

    @pytest.mark.skip(reason="a raw stream has no times")
    def test_times(self):
        pass


def test_instances_are_those_of_the_definition(tmp_path):
    path = tmp_path / "flight"
    path.write_bytes(stamped(encoded(MESSAGES)))
    log = mavstack.open_log(path)
    assert log.schema("BATTERY_STATUS").instance_field == "id"
    assert log["BATTERY_STATUS[1]"]["voltages"][:, 0].tolist() == list(range(1, 60, 2))
    assert len(log.select(instance=0)["BATTERY_STATUS"]) == 30
    assert list(log.select(instance=0)) == ["BATTERY_STATUS"]
    with pytest.raises(
        mavstack.UnknownMessageError, match=r"contains no BATTERY_STATUS\[7\]; instances: 0, 1"
    ):
        log["BATTERY_STATUS[7]"]
    with pytest.raises(mavstack.UnknownMessageError, match="ATTITUDE has no instances"):
        log["ATTITUDE[0]"]
    np.testing.assert_array_equal(log["BATTERY_STATUS"]["voltages[3]"], np.arange(60))

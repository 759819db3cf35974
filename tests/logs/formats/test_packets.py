"""The formats of packets pass the conformance tests of logs."""

from __future__ import annotations

import numpy as np
import pytest

import mavstack
from mavstack.dialects import common
from tests.logs.conformance import LogConformance
from tests.logs.files import START, encoded, stamped

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


PACKETS = encoded(MESSAGES, version=1)
#: Bytes of a record of QGroundControl until 2012: a time and the longest packet of MAVLink 1.
OLD_RECORD = 8 + 263
FORMS = {
    # mavlink-router with LogTelemetry, Mission Planner, MAVProxy
    "times in microseconds": lambda number, packet: (START + number * 50_123).to_bytes(8, "big") + packet,
    # QGroundControl: times in milliseconds, so that some are equal
    "times in milliseconds": lambda number, packet: (START + number // 3 * 1000).to_bytes(8, "big") + packet,
    # QGroundControl until 2013 on a PC
    "little-endian times": lambda number, packet: (START + number * 50_123).to_bytes(8, "little") + packet,
    "records of one length": lambda number, packet: (
        (START + number * 50_123).to_bytes(8, "little") + packet
    ).ljust(OLD_RECORD, b"\x15"),
}


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("name", ["00001-2024-05-01_10-00-00.tlog", "flight.mavlink", "without-suffix"])
def test_telemetry_logs_of_other_programs(tmp_path, form, name):
    path = tmp_path / name
    path.write_bytes(b"".join(FORMS[form](number, packet) for number, packet in enumerate(PACKETS)))
    log = mavstack.open_log(path)
    assert log.format == "tlog"
    assert sum(log.counts.values()) == len(PACKETS)
    assert int(log.start.astype(int)) == START
    times = np.sort(np.concatenate([table["_time"] for table in log.values()])).astype(np.int64) - START
    step = 1000 if "milliseconds" in form else 50_123
    assert set(np.diff(times).tolist()) <= {0, step} if step == 1000 else set(np.diff(times)) == {step}
    padding = sum(OLD_RECORD - 8 - len(packet) for packet in PACKETS) if "length" in form else 0
    assert log.skipped.bad_bytes == padding

"""Logs of one flight on one timeline: by GPS time, by positions in common, or refused."""

from __future__ import annotations

import numpy as np
import pytest

import mavstack
from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError, LogError
from mavstack.logs import merge_logs
from mavstack.services.ftp import MemoryStore
from mavstack.sim.storage import DataflashLogs, UlogLogs
from tests.logs.conformance import column_bytes
from tests.logs.files import encoded
from tests.logs.memory_log import MemoryLog
from tests.sim.storage.samples import Sensors, content, log_start, sample

BOOT = 1_700_000_000_000_000  # UTC of the boot, in µs
LATE = 3_000_000  # the clock of the ground station is 3 s ahead
SECONDS = range(60)


def position(second):
    return 471_234_567 + 83 * second, 85_000_000 + 31 * second


def tlog(folder, *, gps_time=True, system=1, start=0):
    """Write the tlog of a flight, whose packets arrive 0.1 s after they were made."""
    messages = []
    for second in SECONDS:
        lat, lon = position(second)
        boot_ms = second * 1000
        messages.append((second, common.Attitude(time_boot_ms=boot_ms, roll=second / 60)))
        messages.append((second, common.GpsRawInt(time_usec=boot_ms * 1000, fix_type=3, lat=lat, lon=lon)))
        if gps_time and second % 10 == 0:
            messages.append(
                (second, common.SystemTime(time_unix_usec=BOOT + boot_ms * 1000, time_boot_ms=boot_ms))
            )
    packets = encoded([message for _, message in messages], system=system)
    path = folder / f"flight{system}"
    stamps = [BOOT + start + LATE + second * 1_000_000 + 100_000 for second, _ in messages]
    path.write_bytes(
        b"".join(stamp.to_bytes(8, "big") + raw for stamp, raw in zip(stamps, packets, strict=True))
    )
    return mavstack.open_log(path, "common")


def onboard(*, offset_us=BOOT, shift_us=0):
    """Return the vehicle's own log of the flight; `shift_us` moves its time since boot."""
    boot = np.array([second * 1_000_000 + shift_us for second in SECONDS])
    lat, lon = zip(*map(position, SECONDS), strict=True)
    gps = {"TimeUS": boot + 20_000, "Lat": np.array(lat) / 1e7, "Lng": np.array(lon) / 1e7}
    attitude = {"TimeUS": boot, "Roll": np.degrees(np.arange(60) / 60)}
    return MemoryLog({"GPS": gps, "ATT": attitude}, offset_us)


def test_logs_with_gps_time_are_put_on_utc(tmp_path):
    ground, own = tlog(tmp_path), onboard()
    merged = merge_logs(ground, own)
    tlog_offset, own_offset = merged.offsets
    assert (own_offset.label, own_offset.source, own_offset.offset_us) == ("dataflash", "reference", 0)
    assert (tlog_offset.label, tlog_offset.source, tlog_offset.matches) == ("tlog", "GPS time", 60)
    assert tlog_offset.offset_us == -(LATE + 100_000), "the ground's clock and the latency of the link"
    assert 5000 <= tlog_offset.uncertainty_us <= 25_000
    assert tlog_offset.describe() == "tlog: -3.100 s ± 20 ms (GPS time, 60 common fixes)"
    assert set(merged) == {"ATTITUDE", "GPS_RAW_INT", "SYSTEM_TIME", "GPS", "ATT"}
    np.testing.assert_array_equal(merged["ATTITUDE"]["_time"], merged["ATT"]["_time"])
    assert merged.clock == "utc"
    assert merged.start == np.datetime64(BOOT, "us")
    assert merged.duration == pytest.approx(59.02, abs=0.02)
    assert merged.skipped.bad_bytes == 7
    assert ground["ATTITUDE"]["_time"][0] == np.datetime64(BOOT + LATE + 100_000, "us"), "unchanged"


def test_a_log_without_gps_time_is_put_beside_its_positions(tmp_path):
    merged = merge_logs(tlog(tmp_path, gps_time=False), onboard())
    offset = merged.offsets[0]
    assert (offset.source, offset.matches) == ("GPS positions", 60)
    assert offset.offset_us == pytest.approx(-(LATE + 100_000), abs=25_000)
    difference = merged["ATTITUDE"]["_time"] - merged["ATT"]["_time"]
    assert np.abs(difference.astype(int)).max() < 30_000


def test_an_onboard_log_without_utc_gets_it_from_the_tlog(tmp_path):
    merged = merge_logs(onboard(offset_us=None, shift_us=5_000_000), tlog(tmp_path))
    assert [offset.source for offset in merged.offsets] == ["GPS positions", "reference"]
    assert merged.offsets[0].offset_us == BOOT - 5_000_000 - 20_000
    assert not np.isnat(merged["ATT"]["_time"]).any()
    np.testing.assert_allclose(merged.times("ATT", "boot")[:2], [5, 6])


def test_a_wrong_gps_time_is_corrected_by_the_positions(tmp_path):
    leap_seconds = 18_000_000
    merged = merge_logs(onboard(offset_us=BOOT + leap_seconds), tlog(tmp_path))
    shift = merged.offsets[1]
    assert (shift.source, shift.matches) == ("GPS positions", 60)
    difference = merged["ATTITUDE"]["_time"] - merged["ATT"]["_time"]
    assert np.abs(difference.astype(int)).max() < 30_000


def test_logs_without_anything_in_common_are_refused(tmp_path):
    own = onboard(offset_us=None)
    own.rows["GPS"]["Lat"] += 1
    with pytest.raises(LogError, match=r"cannot merge .*: one has no GPS time, and they have fewer than 5"):
        merge_logs(tlog(tmp_path), own)
    with pytest.raises(InvalidArgumentError, match="at least two logs"):
        merge_logs(own)


def test_a_parked_vehicle_has_no_fingerprints(tmp_path):
    own = onboard(offset_us=None)
    own.rows["GPS"]["Lat"], own.rows["GPS"]["Lng"] = 47.1234567, 8.5
    with pytest.raises(LogError, match="positions in common"):
        merge_logs(tlog(tmp_path), own)


def test_two_tlogs_keep_their_tables_apart(tmp_path):
    (tmp_path / "second").mkdir()
    merged = merge_logs(tlog(tmp_path), tlog(tmp_path / "second", start=7_000_000))
    assert {"ATTITUDE", "tlog 2:ATTITUDE"} <= set(merged)
    np.testing.assert_array_equal(merged["ATTITUDE"]["_time"], merged["tlog 2:ATTITUDE"]["_time"])
    assert list(merged.logs) == ["tlog", "tlog 2"]
    assert merged.offsets[1].offset_us == -(LATE + 7_100_000)


def test_windows_and_records_are_those_of_the_tables(tmp_path):
    merged = merge_logs(tlog(tmp_path), onboard())
    calls = []
    windows = list(merged.windows(1000, progress=lambda *call: calls.append(call)))
    for name, table in merged.items():
        parts = np.concatenate([window[name] for window in windows if name in window])
        assert column_bytes(parts) == column_bytes(table)
    assert calls[-1] == (merged.size, merged.size)
    assert {found for window in merged.windows(names=["ATT"]) for found in window} == {"ATT"}
    records = list(merged.records())
    assert len(records) == sum(merged.counts.values())
    times = [record.time for record in records]
    assert times == sorted(times)
    half = merged.select(end=30)
    assert 0 < half.counts["ATT"] < 60


def test_vehicles_in_one_file_are_kept_apart(tmp_path):
    one, two = tlog(tmp_path, system=1), tlog(tmp_path, system=2, start=20_000_000)
    heartbeats = encoded([common.Heartbeat(type=2, autopilot=3)] * 3, system=2)
    stamp = (BOOT + LATE).to_bytes(8, "big")
    (tmp_path / "both").write_bytes(
        one.path.read_bytes() + two.path.read_bytes() + b"".join(stamp + raw for raw in heartbeats)
    )
    both = mavstack.open_log(tmp_path / "both", "common")
    assert {number: vehicle.vehicle_type for number, vehicle in both.vehicles.items()} == {2: "QUADROTOR"}
    mine = both.select(system=2)
    assert mine.counts["ATTITUDE"] == 60
    assert set(mine["ATTITUDE"]["_system"]) == {2}
    merged = merge_logs(mine, onboard())
    assert merged.offsets[0].matches == 60
    assert merged.counts["ATTITUDE"] == 60


@pytest.mark.parametrize("logs_class", [DataflashLogs, UlogLogs], ids=["dataflash", "ulog"])
def test_the_onboard_logs_of_both_firmwares(tmp_path, logs_class):
    logs = logs_class(MemoryStore(), log_start)
    logs.begin(10_000_000)
    for second in range(10, 40):
        lat, lon = position(second)
        sensors = Sensors(gps_latitude=lat / 1e7, gps_longitude=lon / 1e7)
        logs.write(sample(second * 1_000_000, sensors=sensors))
    logs.end()
    path = tmp_path / "onboard"
    path.write_bytes(content(logs, logs.logs()[0].id))
    own = mavstack.open_log(path)
    merged = merge_logs(tlog(tmp_path), own)
    assert merged.offsets[1].source == "reference"
    assert merged.offsets[0].offset_us == pytest.approx(-(LATE + 100_000), abs=300_000)
    assert merged.offsets[0].matches >= 20


def test_texts_and_changes_are_on_the_timeline(tmp_path):
    tlog(tmp_path)
    late = BOOT + LATE + 100_000 + 30_000_000
    more = encoded(
        [
            common.Heartbeat(type=2, autopilot=3),
            common.Statustext(severity=6, text="at 30 s"),
            *(common.ParamValue(param_id="X", param_value=value, param_type=9) for value in (1.0, 2.0)),
        ]
    )
    path = tmp_path / "flight1"
    path.write_bytes(path.read_bytes() + b"".join(late.to_bytes(8, "big") + raw for raw in more))
    for logs in (
        (mavstack.open_log(path, "common"), onboard()),
        (onboard(), mavstack.open_log(path, "common")),
    ):
        merged = merge_logs(*logs)
        expected = np.datetime64(BOOT + 30_000_000, "us")
        assert [text.time for text in merged.texts] == [expected]
        assert [change.time for change in merged.parameter_changes] == [expected]


def test_logs_that_share_no_time_are_refused(tmp_path):
    ground = tlog(tmp_path)
    late = MemoryLog({"ATT": {"TimeUS": np.arange(5) * 1_000_000}}, BOOT + 9 * 365 * 86_400_000_000)
    with pytest.raises(LogError, match=r"do not overlap: .* 2023-11-14 .*2032-.* UTC; merge logs"):
        merge_logs(ground, late)

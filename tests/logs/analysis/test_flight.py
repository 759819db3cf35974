"""Flights in logs that the vehicle wrote: firmware of 2015 without times of events, and PX4."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

from mavstack.logs import open_log
from mavstack.logs.analysis import analyse, flights
from mavstack.logs.query import query_logs
from mavstack.logs.report import make_report
from tests.logs.dataflash.writer import LogWriter
from tests.logs.ulog.ulog_files import UlogBuilder

FOLDER = Path(os.environ.get("MAVSTACK_REALDATA", "/nonexistent"))

#: Types of ArduCopter 3.2 and 3.3: events and errors have no time, CURR holds integers.
OLD_TYPES = (
    (1, "GPS", "BIHBcLLeeEefI", "Status,TimeMS,Week,NSats,HDop,Lat,Lng,RelAlt,Alt,Spd,GCrs,VZ,T"),
    (2, "CURR", "IhIhhhf", "TimeMS,ThrOut,ThrInt,Volt,Curr,Vcc,CurrTot"),
    (3, "EV", "B", "Id"),
    (4, "ERR", "BB", "Subsys,ECode"),
    (5, "VIBE", "IfffIII", "TimeMS,VibeX,VibeY,VibeZ,Clip0,Clip1,Clip2"),
    (6, "MSG", "Z", "Message"),
    (7, "CTUN", "If", "TimeMS,Alt"),
)
ARMED, DISARMED, LANDED, TAKEN_OFF = 10, 11, 18, 28
#: Seconds of the first flight: armed, takeoff, landing, disarmed; the log has a gap before the second one.
FIRST = (10, 20, 40, 50)
SECOND = (110, 120, 140, 150)


def second_of(log, second, *, flying, clipped):
    """Write the records of a second."""
    time_ms = 1000 * second
    fix = 3 if second >= FIRST[1] else 1
    log.write("GPS", fix, 3_600_000 + time_ms, 1800, 9, 90, 473977418, 85455938, 0, 48800, 0, 0, 0, time_ms)
    log.write("CURR", time_ms, 500, 0, 1491, 2744 if flying else 50, 5012, 100.0)
    log.write("VIBE", time_ms, 3.0, 4.0, 5.0, clipped, 0, 0)
    log.write("CTUN", time_ms, 10.0 if flying else 0.0)


def old_copter_log():
    """Return the log of two flights, which is written while the vehicle is armed."""
    log = LogWriter(OLD_TYPES)
    log.write("MSG", "ArduCopter V3.3-rc5 (998ba93a)")
    for armed, takeoff, landing, disarmed in (FIRST, SECOND):
        log.write("EV", ARMED)
        for second in range(armed, disarmed):
            second_of(
                log, second, flying=takeoff <= second < landing, clipped=0 if armed == FIRST[0] else 500
            )
            if second == takeoff:
                log.write("EV", TAKEN_OFF)
            if second == landing:
                log.write("ERR", 6, 1)
                log.write("EV", LANDED)
        log.write("EV", DISARMED)
    return log


@pytest.fixture
def old(tmp_path):
    path = tmp_path / "copter33.BIN"
    path.write_bytes(bytes(old_copter_log().data))
    return open_log(path)


def test_events_without_a_time_take_the_time_of_the_record_before_them(old):
    seconds = old.boot_times("EV", old["EV"])
    assert seconds.tolist() == [10, 20, 40, 49, 49, 120, 140, 149]
    assert old.boot_times("ERR", old["ERR"]).tolist() == [40, 140]
    some = old.select("EV", start=old.start + np.timedelta64(100, "s"))["EV"]
    assert some["Id"].tolist() == [TAKEN_OFF, LANDED, DISARMED]
    assert not np.isnat(old["EV"]["_time"]).any()


def test_a_text_log_gives_events_the_same_times(tmp_path):
    lines = [f"FMT, {number}, 9, {name}, {code}, {labels}" for number, name, code, labels in OLD_TYPES]
    path = tmp_path / "copter33.log"
    head = "FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns"
    rows = ["EV, 10", "CTUN, 1000, 0.5", "EV, 28", "CTUN, 3000, 5.5", "EV, 18"]
    path.write_text("\n".join([head, *lines, *rows]) + "\n")
    log = open_log(path)
    assert log.boot_times("EV", log["EV"]).tolist() == [1.0, 1.0, 3.0]


def test_the_report_of_an_old_copter(old):
    (vehicle,) = make_report(old).data["vehicles"]
    facts = vehicle["facts"]
    assert (facts["min_voltage_v"], facts["max_current_a"]) == (14.91, 27.44)
    assert facts["takeoffs"] == 2
    # Seconds from the first record, at 10 s. The first record after the event that arms is a second later.
    assert [(span["start_s"], span["end_s"]) for span in vehicle["armed"]] == [(1, 39), (100, 139)]
    assert facts["armed_s"] == 77
    titles = [finding["title"] for finding in vehicle["findings"]]
    assert "GPS fix lost in flight" not in titles, "it had no fix before takeoff only"
    assert not [title for title in titles if "clipped" in title], "they were counted while it was disarmed"


def test_where_armed_finds_rows(old):
    _, rows = query_logs([old], "SELECT count(*) FROM CTUN WHERE armed")
    assert rows[0][0] > 70


def px4_log(*, states):
    """Return a ULog of PX4 with a state of arming in each second; a parameter changes in the third."""
    log = UlogBuilder(start_us=0).flags()
    log.value("I", "char[3] sys_name", b"PX4")
    log.formats(
        "vehicle_status:uint64_t timestamp;uint8_t arming_state;uint8_t nav_state;",
        "battery_status:uint64_t timestamp;float voltage_v;",
    )
    log.parameter("MAV_SYS_ID", 1)
    log.parameter("TEST", 1.0)
    log.subscribe(1, "vehicle_status")
    log.subscribe(2, "battery_status")
    for second, state in enumerate(states):
        log.record(1, "QBB", second * 1_000_000, state, 2)
        log.record(2, "Qf", second * 1_000_000, 12.0)
        if second == 2:
            log.parameter("TEST", 2.0)
    return bytes(log.data)


@pytest.mark.parametrize(("states", "armed"), [([1, 1, 1, 1, 2, 2, 2, 1, 1], 3), ([1] * 9, 0)])
def test_px4_logs_know_arming_and_modes(tmp_path, states, armed):
    path = tmp_path / "px4.ulg"
    path.write_bytes(px4_log(states=states))
    log = open_log(path)
    (flight,) = flights(log)
    assert flight.system == 1
    assert sum(end - start for start, end in flight.armed_spans) == armed
    assert [span.value for span in flight.mode_spans] == ["POSCTL"]
    assert not [found for found in analyse(flight) if "in flight" in found.title]


@pytest.mark.skipif(not FOLDER.exists(), reason="MAVSTACK_REALDATA names no folder")
@pytest.mark.parametrize(
    ("name", "armed"), [("pyulog_sample_appended_multiple.ulg", 0.0), ("pyulog_sample_log_small.ulg", 5.0)]
)
def test_real_logs_of_px4_know_arming(name, armed):
    (flight,) = flights(open_log(FOLDER / name))
    assert flight.states.armed.is_known
    assert sum(end - start for start, end in flight.armed_spans) == pytest.approx(armed, abs=1.0)

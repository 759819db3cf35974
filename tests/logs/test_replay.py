"""Logs of any format as a tlog that shows their flight."""

from __future__ import annotations

import numpy as np
import pytest

from mavstack.errors import LogError
from mavstack.logs import open_log
from mavstack.logs.flight_states import flight_states
from mavstack.logs.replay import replay_tlog
from tests.logs import flights
from tests.logs.blackbox.writer import flight as blackbox_flight
from tests.logs.dataflash.writer import LogWriter
from tests.logs.ulog.ulog_files import UlogBuilder

TYPES = (
    (2, "ATT", "Qffff", "TimeUS,DesRoll,Roll,Pitch,Yaw", "sdddd", "F----"),
    (3, "POS", "QLLfff", "TimeUS,Lat,Lng,Alt,RelHomeAlt,RelOriginAlt", "sDUmmm", "FGG---"),
    (4, "MODE", "QMBB", "TimeUS,Mode,ModeNum,Rsn", "s---", "F---"),
    (5, "MSG", "QZ", "TimeUS,Message", "s-", "F-"),
    (6, "ARM", "QBIBB", "TimeUS,ArmState,ArmChecks,Forced,Method", "s----", "F----"),
    (7, "BAT", "QBfffB", "TimeUS,Instance,Volt,Curr,CurrTot,RemPct", "s-vA-%", "F-----"),
)  # fmt: skip


@pytest.fixture
def replayed(tmp_path):
    def replay(data, name):
        path = tmp_path / name
        path.write_bytes(data)
        shown = tmp_path / "replay.tlog"
        shown.write_bytes(replay_tlog(open_log(path)))
        return open_log(shown)

    return replay


def dataflash(*, positions=True, attitude=True):
    """Return 20 s of a copter that flies east at 10 m/s, armed from 5 s on."""
    writer = LogWriter(TYPES)
    writer.write("MSG", 1_000_000, "ArduCopter V4.5.7 (2a3dc4b7)")
    writer.write("MSG", 2_000_000, "a text that is longer than the fifty characters of a part")
    writer.write("MODE", 1_000_000, 0, 0, 1)
    writer.write("ARM", 6_000_000, 1, 0, 0, 0)
    writer.write("MODE", 8_000_000, 4, 4, 1)
    for tick in range(200):
        time = 1_000_000 + tick * 100_000
        if tick % 10 == 0:
            writer.write("BAT", time, 0, 15.5, 12.0, 0.0, 80)
        if positions:
            writer.write("POS", time, 470_000_000, 80_000_000 + tick * 100, 500.0, 10.0, 0.0)
        if attitude:
            writer.write("ATT", time, 0.0, 10.0, -5.0, 270.0)
    return bytes(writer.data)


def test_a_dataflash_log_shows_positions_attitude_modes_texts_and_battery(replayed):
    log = replayed(dataflash(), "flight.BIN")
    seconds = np.diff(log.time_span)[0]
    assert 19 <= seconds <= 21
    position = log["GLOBAL_POSITION_INT"]
    assert 95 <= len(position) <= 101
    assert position["lat"].tolist()[0] == 470_000_000
    assert np.diff(position["lon"]).min() > 0
    # 1e-5 degrees of longitude at 47 degrees in a tenth of a second.
    assert position["vx"].tolist()[5] == 0
    assert position["vy"].tolist()[5] == pytest.approx(758, abs=5)
    assert position["relative_alt"].tolist()[5] == 10_000
    assert position["hdg"].tolist()[5] == 27_000
    assert np.degrees(log["ATTITUDE"]["yaw"][0]) == pytest.approx(-90)
    assert np.degrees(log["ATTITUDE"]["pitch"][0]) == pytest.approx(-5)
    assert log["SYS_STATUS"]["voltage_battery"].tolist()[0] == 15_500
    assert [each.text for each in log.texts] == [
        "ArduCopter V4.5.7 (2a3dc4b7)",
        "a text that is longer than the fifty characters of a part",
    ]
    states = flight_states(log)[1]
    assert list(dict.fromkeys(states.mode.values.tolist())) == ["STABILIZE", "GUIDED"]
    assert states.armed.values.tolist().count(False) == 5
    assert log.vehicles[1].vehicle_type == "QUADROTOR"


def test_a_log_without_utc_does_not_begin_in_1970(replayed):
    log = replayed(dataflash(), "flight.BIN")
    assert log.times("HEARTBEAT")[0] == pytest.approx(946_684_800.0 + 1.0)
    assert np.diff(log.times("HEARTBEAT")) == pytest.approx(1.0)


def test_attitude_alone_is_enough(replayed):
    log = replayed(dataflash(positions=False), "flight.BIN")
    assert "GLOBAL_POSITION_INT" not in log
    assert len(log["ATTITUDE"]) > 100


def test_a_ulog_shows_its_flight(replayed):
    builder = UlogBuilder(start_us=1_000_000)
    builder.flags()
    builder.formats(
        "vehicle_attitude:uint64_t timestamp;float[4] q;",
        "vehicle_status:uint64_t timestamp;uint8_t arming_state;uint8_t nav_state;",
        "vehicle_global_position:uint64_t timestamp;double lat;double lon;float alt;",
    )
    for number, topic in enumerate(("vehicle_attitude", "vehicle_status", "vehicle_global_position")):
        builder.subscribe(number, topic)
    for tick in range(100):
        time = 2_000_000 + tick * 100_000
        builder.record(0, "Q4f", time, 1.0, 0.0, 0.0, 0.0)
        builder.record(1, "QBB", time, 2 if tick > 50 else 1, 3 if tick > 60 else 4)
        builder.record(2, "Qddf", time, 47.0, 8.0 + tick * 1e-6, 500.0)
    builder.text(4_000_000, 4, "Failsafe enabled")
    log = replayed(bytes(builder.data), "flight.ulg")
    assert len(log["GLOBAL_POSITION_INT"]) >= 45
    assert len(log["ATTITUDE"]) >= 90
    assert [(each.text, each.severity) for each in log.texts] == [("Failsafe enabled", 4)]
    states = flight_states(log)[1]
    assert list(dict.fromkeys(states.mode.values.tolist())) == ["LOITER", "MISSION"]
    assert states.armed.values.any()
    assert not states.armed.values.all()


def test_a_blackbox_log_shows_its_positions(replayed):
    log = replayed(bytes(blackbox_flight(frames=2000).data), "flight.bbl")
    assert len(log["GLOBAL_POSITION_INT"]) > 1
    assert len(log["HEARTBEAT"]) >= 1


def test_a_log_of_packets_is_replayed_as_it_is(replayed):
    given = flights.flight_tlog()
    log = replayed(given, "flight.tlog")
    assert sum(log.counts.values()) == len(flights.packets())


def test_a_log_without_positions_and_attitude_is_refused(tmp_path):
    writer = LogWriter(TYPES)
    writer.write("MSG", 1000, "ArduCopter V4.5.7 (2a3dc4b7)")
    path = tmp_path / "short.BIN"
    path.write_bytes(bytes(writer.data))
    wanted = "replaying short.BIN failed: the dataflash log has neither positions nor attitude"
    with pytest.raises(LogError, match=wanted):
        replay_tlog(open_log(path))

"""The onboard log of a flight: downloaded over MAVLink, read by other programs."""

from __future__ import annotations

from bisect import bisect
from io import BytesIO
from math import dist
from typing import TYPE_CHECKING

import pytest

from mavstack.sim.motion import LocalFrame
from mavstack.sim.simulation import EPOCH
from mavstack.sim.vehicle_types import DEFAULT_HOME, Firmware, VehicleType
from tests.sim.whole_flights.fleet import ALL
from tests.sim.whole_flights.ground_station import SAMPLES

if TYPE_CHECKING:
    from tests.sim.whole_flights.ground_station import Flight

DFReader = pytest.importorskip("pymavlink.DFReader")
ULog = pytest.importorskip("pyulog").ULog
COPTER = VehicleType.COPTER
#: The log holds the estimated position; GPS errs by about a metre.
NEAR = 3.0
Place = tuple[float, float, float]


@pytest.mark.parametrize(("kind", "firmware"), ALL, ids=str)
def test_each_flight_is_listed(calm, kind, firmware) -> None:
    flight = calm[kind, firmware]
    assert len(flight.logs) == 1
    assert flight.logs[0].size > 2000 * (flight.ended - flight.began)
    assert flight.logs[0].time_utc == pytest.approx(EPOCH + flight.began, abs=2)


@pytest.fixture(scope="module")
def ardupilot_log(calm, tmp_path_factory):
    path = tmp_path_factory.mktemp("log") / "flight.bin"
    path.write_bytes(calm[COPTER, Firmware.ARDUPILOT].log)
    log = DFReader.DFReader_binary(str(path))
    found: dict[str, list] = {"POS": [], "MSG": [], "CMD": [], "BAT": [], "MODE": []}
    while (message := log.recv_match(type=list(found))) is not None:
        found[message.get_type()].append(message.to_dict())
    log.close()
    return found


@pytest.fixture(scope="module")
def px4_log(calm):
    wanted = ["vehicle_global_position", "vehicle_local_position", "battery_status", "vehicle_status"]
    log = ULog(BytesIO(calm[COPTER, Firmware.PX4].log), wanted)
    return {data.name: data.data for data in log.data_list}, log


def test_an_ardupilot_log_has_all_its_bytes(calm, ardupilot_log) -> None:
    flight = calm[COPTER, Firmware.ARDUPILOT]
    assert len(flight.log) == flight.logs[0].size
    seconds = flight.ended - flight.began
    assert len(ardupilot_log["POS"]) == pytest.approx(10 * seconds, rel=0.05)


def test_an_ardupilot_log_holds_the_track(calm, ardupilot_log) -> None:
    track = [
        (each["TimeUS"] / 1e6, place(each["Lat"], each["Lng"], each["Alt"])) for each in ardupilot_log["POS"]
    ]
    assert_flown(calm[COPTER, Firmware.ARDUPILOT], track)


def test_an_ardupilot_log_holds_what_was_said_and_done(calm, ardupilot_log) -> None:
    flight = calm[COPTER, Firmware.ARDUPILOT]
    said = [each["Message"] for each in ardupilot_log["MSG"]]
    assert [text for text in said if text.startswith("Mission: ")] == [
        text for text in flight.journal.texts if text.startswith("Mission: ")
    ]
    flown = [each["CNum"] for each in ardupilot_log["CMD"]]
    assert [seq for seq in flown if seq in flight.plan.order][-8:] == flight.plan.order[-8:]
    drawn = ardupilot_log["BAT"][-1]["CurrTot"]
    assert drawn == pytest.approx(flight.flown[-1].battery.consumed, rel=0.02)


def test_a_px4_log_has_all_its_bytes(calm, px4_log) -> None:
    flight = calm[COPTER, Firmware.PX4]
    assert len(flight.log) == flight.logs[0].size
    assert not px4_log[1].file_corruption


def test_a_px4_log_holds_the_track(calm, px4_log) -> None:
    values = px4_log[0]["vehicle_global_position"]
    rows = zip(values["timestamp"], values["lat"], values["lon"], values["alt"], strict=True)
    track = [(time / 1e6, place(*where)) for time, *where in rows]
    assert_flown(calm[COPTER, Firmware.PX4], track)


def test_a_px4_log_holds_the_battery(calm, px4_log) -> None:
    flown = calm[COPTER, Firmware.PX4].flown
    volts = px4_log[0]["battery_status"]["voltage_v"]
    assert volts[0] == pytest.approx(flown[0].battery.voltage, abs=0.6)
    assert volts[-1] == pytest.approx(flown[-1].battery.voltage, abs=0.6)


def place(latitude: float, longitude: float, altitude: float) -> Place:
    return LocalFrame(*DEFAULT_HOME[:3]).to_local(latitude, longitude, altitude)


def assert_flown(flight: Flight, logged: list[tuple[float, Place]]) -> None:
    """Assert that each logged position, by seconds from boot, is close to the true one."""
    times = [sample.time for sample in flight.track]
    offs = []
    for time, where in logged:
        sample = flight.track[min(bisect(times, time), len(times) - 1)]
        passed = time - sample.time
        assert abs(passed) <= 1.01 / SAMPLES
        motion = sample.motion
        then = [at + speed * passed for at, speed in zip(motion[:3], motion[3:6], strict=True)]
        offs.append(dist(then, where))
    assert len(offs) > 4 * (flight.ended - flight.began)
    assert max(offs) < NEAR

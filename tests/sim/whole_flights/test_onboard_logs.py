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

pytestmark = pytest.mark.nightly

DFReader = pytest.importorskip("pymavlink.DFReader")
ULog = pytest.importorskip("pyulog").ULog
COPTER = VehicleType.COPTER
#: The log holds the estimated position; GPS errs by about a metre.
MAX_POSITION_ERROR = 3.0
Place = tuple[float, float, float]


@pytest.mark.parametrize(("kind", "firmware"), ALL, ids=str)
def test_each_flight_has_a_log_entry(still_air, kind, firmware) -> None:
    flight = still_air[kind, firmware]
    assert len(flight.logs) == 1
    assert flight.logs[0].size > 2000 * (flight.ended - flight.began)
    assert flight.logs[0].time_utc == pytest.approx(EPOCH + flight.began, abs=2)


@pytest.fixture(scope="module")
def ardupilot_log(still_air, tmp_path_factory):
    path = tmp_path_factory.mktemp("log") / "flight.bin"
    path.write_bytes(still_air[COPTER, Firmware.ARDUPILOT].log)
    log = DFReader.DFReader_binary(str(path))
    found: dict[str, list] = {"POS": [], "MSG": [], "CMD": [], "BAT": [], "MODE": []}
    while (message := log.recv_match(type=list(found))) is not None:
        found[message.get_type()].append(message.to_dict())
    log.close()
    return found


@pytest.fixture(scope="module")
def px4_log(still_air):
    wanted = ["vehicle_global_position", "vehicle_local_position", "battery_status", "vehicle_status"]
    log = ULog(BytesIO(still_air[COPTER, Firmware.PX4].log), wanted)
    return {data.name: data.data for data in log.data_list}, log


def test_ardupilot_log_is_complete(still_air, ardupilot_log) -> None:
    flight = still_air[COPTER, Firmware.ARDUPILOT]
    assert len(flight.log) == flight.logs[0].size
    seconds = flight.ended - flight.began
    assert len(ardupilot_log["POS"]) == pytest.approx(10 * seconds, rel=0.05)


def test_ardupilot_log_contains_the_track(still_air, ardupilot_log) -> None:
    track = [
        (each["TimeUS"] / 1e6, place(each["Lat"], each["Lng"], each["Alt"])) for each in ardupilot_log["POS"]
    ]
    assert_near_track(still_air[COPTER, Firmware.ARDUPILOT], track)


def test_ardupilot_log_contains_texts_commands_and_battery(still_air, ardupilot_log) -> None:
    flight = still_air[COPTER, Firmware.ARDUPILOT]
    texts = [each["Message"] for each in ardupilot_log["MSG"]]
    assert [text for text in texts if text.startswith("Mission: ")] == [
        text for text in flight.journal.texts if text.startswith("Mission: ")
    ]
    flown = [each["CNum"] for each in ardupilot_log["CMD"]]
    assert [seq for seq in flown if seq in flight.plan.order][-8:] == flight.plan.order[-8:]
    consumed = ardupilot_log["BAT"][-1]["CurrTot"]
    assert consumed == pytest.approx(flight.flown[-1].battery.consumed, rel=0.02)


def test_px4_log_is_complete(still_air, px4_log) -> None:
    flight = still_air[COPTER, Firmware.PX4]
    assert len(flight.log) == flight.logs[0].size
    assert not px4_log[1].file_corruption


def test_px4_log_contains_the_track(still_air, px4_log) -> None:
    values = px4_log[0]["vehicle_global_position"]
    rows = zip(values["timestamp"], values["lat"], values["lon"], values["alt"], strict=True)
    track = [(time / 1e6, place(*logged_place)) for time, *logged_place in rows]
    assert_near_track(still_air[COPTER, Firmware.PX4], track)


def test_px4_log_contains_the_battery(still_air, px4_log) -> None:
    flown = still_air[COPTER, Firmware.PX4].flown
    volts = px4_log[0]["battery_status"]["voltage_v"]
    assert volts[0] == pytest.approx(flown[0].battery.voltage, abs=0.6)
    assert volts[-1] == pytest.approx(flown[-1].battery.voltage, abs=0.6)


def place(latitude: float, longitude: float, altitude: float) -> Place:
    return LocalFrame(*DEFAULT_HOME[:3]).to_local(latitude, longitude, altitude)


def assert_near_track(flight: Flight, logged: list[tuple[float, Place]]) -> None:
    """Assert that each logged position, by seconds from boot, is close to the true one."""
    times = [sample.time for sample in flight.track]
    errors = []
    for time, logged_place in logged:
        sample = flight.track[min(bisect(times, time), len(times) - 1)]
        elapsed = time - sample.time
        assert abs(elapsed) <= 1.01 / SAMPLES
        motion = sample.motion
        expected = [at + speed * elapsed for at, speed in zip(motion[:3], motion[3:6], strict=True)]
        errors.append(dist(expected, logged_place))
    assert len(errors) > 4 * (flight.ended - flight.began)
    assert max(errors) < MAX_POSITION_ERROR

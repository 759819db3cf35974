"""Which messages come, and how often: by themselves, by parameters, and as clients ask."""

from __future__ import annotations

import pytest

from mavstack.dialects import ardupilotmega as dialect
from mavstack.dialects import common
from mavstack.sim.telemetry import Link, use_link
from mavstack.sim.telemetry.ardupilot import GROUPS, ONLY
from mavstack.sim.telemetry.px4 import RATES
from mavstack.sim.vehicle_types import Firmware, VehicleType
from tests.sim.telemetry.flight import KINDS, NAMES, Flight

PX4, ARDUPILOT = Firmware.PX4, Firmware.ARDUPILOT
_SECONDS = 20.0
#: The issue's list, by who sends them; others are only for some types, or only in flight.
EVERYWHERE = {"SysStatus", "GpsRawInt", "BatteryStatus", "Vibration", "ServoOutputRaw", "Attitude", "VfrHud"}
EVERYWHERE |= {"GlobalPositionInt", "LocalPositionNed", "ScaledPressure", "MissionCurrent", "Heartbeat"}
OF_ARDUPILOT = {"EkfStatusReport", "RcChannels", "RawImu", "NavControllerOutput", "SystemTime", "Ahrs"}
OF_PX4 = {"EstimatorStatus", "ExtendedSysState", "HomePosition", "AttitudeQuaternion", "Altitude"}


@pytest.mark.parametrize(("kind", "firmware"), KINDS, ids=NAMES)
def test_every_type_sends_at_least_the_usual_set(kind, firmware):
    flight = Flight(kind, firmware)
    flight.run(3.0)
    heard = set(flight.rates(11.0))
    assert heard >= EVERYWHERE | (OF_PX4 if firmware is PX4 else OF_ARDUPILOT)
    if kind in (VehicleType.PLANE, VehicleType.VTOL):
        assert ("WindCov" if firmware is PX4 else "Wind") in heard
    assert flight.port.state.unsendable == 0


def test_ardupilots_groups_come_at_the_rate_of_their_parameters():
    rates = {
        "RAW_SENS": 1,
        "EXT_STAT": 2,
        "POSITION": 3,
        "RC_CHAN": 5,
        "EXTRA1": 10,
        "EXTRA2": 0,
        "EXTRA3": 4,
    }
    flight = Flight(VehicleType.COPTER, ARDUPILOT, **{f"SR0_{name}": rate for name, rate in rates.items()})
    flight.run(3.0)
    heard = flight.rates(_SECONDS)
    silent = {
        dialect.FenceStatus,
        dialect.PositionTargetGlobalInt,
        dialect.DistanceSensor,
        dialect.Rangefinder,
    }
    for name, _, kinds in GROUPS:
        for kind in kinds:
            if VehicleType.COPTER in ONLY.get(kind, VehicleType) and kind not in silent:
                assert heard[kind.__name__] == pytest.approx(rates[name] * _SECONDS, abs=1), kind


@pytest.mark.parametrize("kind", VehicleType)
def test_a_ground_stations_usual_rate_is_four_a_second(kind):
    flight = Flight(kind, ARDUPILOT)
    flight.run(3.0)
    heard = flight.rates(5.0)
    assert heard["Attitude"] == heard["RawImu"] == heard["SysStatus"] == pytest.approx(20, abs=1)


def test_a_parameter_set_in_flight_changes_the_rate_at_once():
    flight = Flight(VehicleType.PLANE, ARDUPILOT, SR0_EXTRA1=4)
    flight.run(3.0)
    flight.send(
        common.ParamSet(
            target_system=1,
            target_component=1,
            param_id="SR0_EXTRA1",
            param_value=10.0,
            param_type=common.MavParamType.INT16,
        )
    )
    flight.run(0.2)
    heard = flight.rates(10.0)
    assert heard["Attitude"] == pytest.approx(100, abs=2)
    assert heard["VfrHud"] == pytest.approx(40, abs=2)
    flight.vehicle.parameters.set("SR0_EXTRA1", 0)
    assert flight.rates(5.0)["Attitude"] <= 1


def test_ardupilot_obeys_requests_for_groups():
    flight = Flight(VehicleType.COPTER, ARDUPILOT, **{f"SR0_{name}": 0 for name, _, _ in GROUPS})
    flight.run(3.0)
    assert set(flight.rates(5.0)) <= {"Heartbeat", "CurrentMode"}
    request = {"target_system": 1, "target_component": 1, "start_stop": 1}
    flight.send(
        common.RequestDataStream(**request, req_stream_id=dialect.MavDataStream.EXTRA1, req_message_rate=5)
    )
    heard = flight.rates(10.0)
    assert heard["Attitude"] == heard["Ahrs2"] == pytest.approx(50, abs=1)
    assert heard["VfrHud"] == 0
    flight.send(
        common.RequestDataStream(**request, req_stream_id=dialect.MavDataStream.ALL, req_message_rate=4)
    )
    heard = flight.rates(10.0)
    assert heard["Attitude"] == heard["VfrHud"] == heard["SysStatus"] == pytest.approx(40, abs=1)
    assert heard["AttitudeQuaternion"] == 0


@pytest.mark.parametrize("link", Link)
@pytest.mark.parametrize("kind", [VehicleType.COPTER, VehicleType.PLANE])
def test_px4s_rates_are_those_of_its_link(kind, link):
    flight = Flight(kind, PX4)
    flight.run(3.0)
    use_link(flight.vehicle, link)
    flight.run(1.0)
    heard = flight.rates(_SECONDS)
    missing = {common.NavControllerOutput, common.OrbitExecutionStatus, common.PositionTargetGlobalInt}
    missing |= {common.RcChannels}
    copter = kind is VehicleType.COPTER
    missing |= {common.WindCov} if copter else {common.EscInfo, common.EscStatus}
    for row in RATES:
        expected = 0.0 if row[0] in missing else row[1 + tuple(Link).index(link)]
        expected = min(expected, 50.0) * _SECONDS
        assert heard[row[0].__name__] == pytest.approx(expected, abs=max(1.0, 0.02 * expected)), row[0]


def test_px4_on_its_simulations_links_is_as_busy_as_the_real_one():
    flight = Flight(VehicleType.COPTER, PX4)
    flight.run(3.0)
    assert flight.rates(10.0).total() / 10.0 == pytest.approx(372.8, rel=0.01)
    use_link(flight.vehicle, Link.ONBOARD)
    flight.run(1.0)
    # 50 of its ATTITUDE a second do not fit into steps of 20 ms
    assert flight.rates(10.0).total() / 10.0 == pytest.approx(428.8 - 50.0, rel=0.01)


def test_px4_does_not_know_groups():
    flight = Flight(VehicleType.COPTER, PX4)
    flight.run(3.0)
    flight.send(
        common.RequestDataStream(target_system=1, target_component=1, req_message_rate=1, start_stop=1)
    )
    heard = flight.rates(4.0)
    assert heard["Attitude"] == pytest.approx(200, abs=4)
    assert heard["DataStream"] == 0


@pytest.mark.parametrize("firmware", Firmware)
def test_an_interval_can_be_set_and_set_back(firmware):
    flight = Flight(VehicleType.COPTER, firmware)
    flight.run(3.0)
    usual = flight.rates(5.0)["Attitude"]
    for interval, count in ((100_000, 50), (-1, 0), (0, usual)):
        flight.command(common.MavCmd.SET_MESSAGE_INTERVAL, 30, interval)
        flight.run(0.1)
        assert flight.rates(5.0)["Attitude"] == pytest.approx(count, abs=2)


@pytest.mark.parametrize("firmware", Firmware)
@pytest.mark.parametrize("kind", [common.ExtendedSysState, common.HomePosition, common.AttitudeQuaternion])
def test_what_is_not_sent_can_be_asked_for(firmware, kind):
    flight = Flight(VehicleType.COPTER, firmware)
    flight.run(3.0)
    flight.command(common.MavCmd.SET_MESSAGE_INTERVAL, kind.__mavlink_row__[0], -1)
    flight.run(0.1)
    assert flight.rates(3.0)[kind.__name__] == 0
    flight.packets.clear()
    flight.command(common.MavCmd.REQUEST_MESSAGE, kind.__mavlink_row__[0])
    flight.run(0.1)
    assert [packet.message for _, packet in flight.packets if isinstance(packet.message, kind)]


def test_neighbours_of_a_fleet_do_not_send_in_the_same_steps():
    first = [_first_attitude(system) for system in range(1, 9)]
    assert len({round(moment, 3) for moment in first}) >= 6


def _first_attitude(system: int) -> float:
    flight = Flight(VehicleType.COPTER, ARDUPILOT, system=system)
    flight.run(1.0)
    return next(now for now, packet in flight.packets if isinstance(packet.message, common.Attitude))


def test_px4s_parameter_chooses_the_link_of_the_next_boot():
    flight = Flight(VehicleType.COPTER, PX4, MAV_0_MODE=2)
    flight.run(3.0)
    assert flight.rates(2.0)["HighresImu"] == pytest.approx(100, abs=2)
    flight.vehicle.parameters.set("MAV_0_MODE", 0)
    flight.vehicle.reboot()
    flight.run(3.0)
    assert flight.rates(2.0)["HighresImu"] == 0

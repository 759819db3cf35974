"""Streamed messages and their rates: by default, by parameters, and on request."""

from __future__ import annotations

import pytest

from mavstack.dialects import ardupilotmega as dialect
from mavstack.dialects import common
from mavstack.sim.telemetry import LinkMode, set_link_mode
from mavstack.sim.telemetry.ardupilot import GROUPS, TYPES_SENDING
from mavstack.sim.telemetry.px4 import RATES, link_rates
from mavstack.sim.vehicle_types import Firmware, VehicleType
from tests.sim.telemetry.flight import VEHICLE_IDS, VEHICLES, Flight

PX4, ARDUPILOT = Firmware.PX4, Firmware.ARDUPILOT
_SECONDS = 20.0
#: Messages that every type sends, by firmware; others are sent by some types or in flight only.
SENT_BY_ALL = {"SysStatus", "GpsRawInt", "BatteryStatus", "Vibration", "ServoOutputRaw", "Attitude", "VfrHud"}
SENT_BY_ALL |= {"GlobalPositionInt", "LocalPositionNed", "ScaledPressure", "MissionCurrent", "Heartbeat"}
SENT_BY_ARDUPILOT = {"EkfStatusReport", "RcChannels", "RawImu", "NavControllerOutput", "SystemTime", "Ahrs"}
SENT_BY_PX4 = {"EstimatorStatus", "ExtendedSysState", "HomePosition", "AttitudeQuaternion", "Altitude"}


@pytest.mark.fast_cases(2)
@pytest.mark.parametrize(("vehicle_type", "firmware"), VEHICLES, ids=VEHICLE_IDS)
def test_every_type_sends_the_common_messages(vehicle_type, firmware):
    flight = Flight(vehicle_type, firmware)
    flight.run(3.0)
    counts = set(flight.rates(11.0))
    assert counts >= SENT_BY_ALL | (SENT_BY_PX4 if firmware is PX4 else SENT_BY_ARDUPILOT)
    if vehicle_type in (VehicleType.PLANE, VehicleType.VTOL):
        assert ("WindCov" if firmware is PX4 else "Wind") in counts
    assert flight.port.state.unsendable == 0


@pytest.mark.flight
def test_ardupilot_groups_follow_their_rate_parameters():
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
    counts = flight.rates(_SECONDS)
    not_sent = {
        dialect.FenceStatus,
        dialect.PositionTargetGlobalInt,
        dialect.DistanceSensor,
        dialect.Rangefinder,
        dialect.ObstacleDistance,
        dialect.WinchStatus,
        dialect.GeneratorStatus,
        dialect.EfiStatus,
    }
    for name, _, message_types in GROUPS:
        for message_type in message_types:
            if (
                VehicleType.COPTER in TYPES_SENDING.get(message_type, VehicleType)
                and message_type not in not_sent
            ):
                assert counts[message_type.__name__] == pytest.approx(rates[name] * _SECONDS, abs=1), (
                    message_type
                )


@pytest.mark.fast_cases(4)
@pytest.mark.parametrize("vehicle_type", VehicleType)
def test_ardupilot_default_rate_is_four_hertz(vehicle_type):
    flight = Flight(vehicle_type, ARDUPILOT)
    flight.run(3.0)
    counts = flight.rates(5.0)
    assert counts["Attitude"] == counts["RawImu"] == counts["SysStatus"] == pytest.approx(20, abs=1)


@pytest.mark.flight
def test_parameter_change_in_flight_changes_the_rate():
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
    counts = flight.rates(10.0)
    assert counts["Attitude"] == pytest.approx(100, abs=2)
    assert counts["VfrHud"] == pytest.approx(40, abs=2)
    flight.vehicle.parameters.set("SR0_EXTRA1", 0)
    assert flight.rates(5.0)["Attitude"] <= 1


@pytest.mark.flight
def test_ardupilot_follows_request_data_stream():
    flight = Flight(VehicleType.COPTER, ARDUPILOT, **{f"SR0_{name}": 0 for name, _, _ in GROUPS})
    flight.run(3.0)
    assert set(flight.rates(5.0)) <= {"Heartbeat", "CurrentMode"}
    request = {"target_system": 1, "target_component": 1, "start_stop": 1}
    flight.send(
        common.RequestDataStream(**request, req_stream_id=dialect.MavDataStream.EXTRA1, req_message_rate=5)
    )
    counts = flight.rates(10.0)
    assert counts["Attitude"] == counts["Ahrs2"] == pytest.approx(50, abs=1)
    assert counts["VfrHud"] == 0
    flight.send(
        common.RequestDataStream(**request, req_stream_id=dialect.MavDataStream.ALL, req_message_rate=4)
    )
    counts = flight.rates(10.0)
    assert counts["Attitude"] == counts["VfrHud"] == counts["SysStatus"] == pytest.approx(40, abs=1)
    assert counts["AttitudeQuaternion"] == 0


@pytest.mark.fast_cases(1)
@pytest.mark.flight_cases(3)
@pytest.mark.parametrize("link", LinkMode)
@pytest.mark.parametrize("vehicle_type", [VehicleType.COPTER, VehicleType.PLANE])
def test_px4_rates_follow_the_link_mode(vehicle_type, link):
    flight = Flight(vehicle_type, PX4)
    flight.run(3.0)
    set_link_mode(flight.vehicle, link)
    flight.run(1.0)
    counts = flight.rates(_SECONDS)
    missing = {common.NavControllerOutput, common.OrbitExecutionStatus, common.PositionTargetGlobalInt}
    missing |= {common.RcChannels, common.ObstacleDistance}
    copter = vehicle_type is VehicleType.COPTER
    missing |= {common.WindCov} if copter else {common.EscInfo, common.EscStatus}
    for row in RATES:
        expected = 0.0 if row[0] in missing else link_rates(flight.vehicle, link)[row[0]]
        expected = min(expected, 50.0) * _SECONDS
        assert counts[row[0].__name__] == pytest.approx(expected, abs=max(1.0, 0.02 * expected)), row[0]


def test_px4_shared_link_carries_what_mavsdk_and_a_ground_station_need():
    flight = Flight(VehicleType.COPTER, PX4)
    flight.run(3.0)
    counts = flight.rates(5.0)
    assert counts["HighresImu"] == counts["Odometry"] == pytest.approx(50, abs=1)
    assert counts["SystemTime"] == pytest.approx(5, abs=1)
    ground = link_rates(flight.vehicle, LinkMode.GROUND)
    onboard = {common.HighresImu, common.Odometry, common.SystemTime}
    assert {message for message, rate in link_rates(flight.vehicle, LinkMode.SHARED).items() if rate} == {
        message for message, rate in ground.items() if rate
    } | onboard


@pytest.mark.flight
def test_px4_total_rates_match_sitl():
    flight = Flight(VehicleType.COPTER, PX4)
    flight.run(3.0)
    set_link_mode(flight.vehicle, LinkMode.GROUND)
    flight.run(1.0)
    assert flight.rates(10.0).total() / 10.0 == pytest.approx(372.8, rel=0.01)
    set_link_mode(flight.vehicle, LinkMode.ONBOARD)
    flight.run(1.0)
    # the onboard link sends ATTITUDE at 100 Hz, but a step takes 20 ms
    assert flight.rates(10.0).total() / 10.0 == pytest.approx(428.8 - 50.0, rel=0.01)


def test_px4_ignores_request_data_stream():
    flight = Flight(VehicleType.COPTER, PX4)
    flight.run(3.0)
    flight.send(
        common.RequestDataStream(target_system=1, target_component=1, req_message_rate=1, start_stop=1)
    )
    counts = flight.rates(4.0)
    assert counts["Attitude"] == pytest.approx(200, abs=4)
    assert counts["DataStream"] == 0


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize("firmware", Firmware)
def test_message_interval_can_be_set_and_reset(firmware):
    flight = Flight(VehicleType.COPTER, firmware)
    flight.run(3.0)
    default_count = flight.rates(5.0)["Attitude"]
    for interval, count in ((100_000, 50), (-1, 0), (0, default_count)):
        flight.command(common.MavCmd.SET_MESSAGE_INTERVAL, 30, interval)
        flight.run(0.1)
        assert flight.rates(5.0)["Attitude"] == pytest.approx(count, abs=2)


@pytest.mark.fast_cases(4)
@pytest.mark.parametrize("firmware", Firmware)
@pytest.mark.parametrize(
    "message_type", [common.ExtendedSysState, common.HomePosition, common.AttitudeQuaternion]
)
def test_message_without_a_stream_can_be_requested(firmware, message_type):
    flight = Flight(VehicleType.COPTER, firmware)
    flight.run(3.0)
    flight.command(common.MavCmd.SET_MESSAGE_INTERVAL, message_type.__mavlink_row__[0], -1)
    flight.run(0.1)
    assert flight.rates(3.0)[message_type.__name__] == 0
    flight.packets.clear()
    flight.command(common.MavCmd.REQUEST_MESSAGE, message_type.__mavlink_row__[0])
    flight.run(0.1)
    assert [packet.message for _, packet in flight.packets if isinstance(packet.message, message_type)]


def test_vehicles_of_a_fleet_start_streams_at_different_times():
    first = [_first_attitude(system) for system in range(1, 9)]
    assert len({round(moment, 3) for moment in first}) >= 6


def _first_attitude(system: int) -> float:
    flight = Flight(VehicleType.COPTER, ARDUPILOT, system=system)
    flight.run(1.0)
    return next(now for now, packet in flight.packets if isinstance(packet.message, common.Attitude))


def test_px4_parameter_sets_the_link_mode_of_the_next_boot():
    flight = Flight(VehicleType.COPTER, PX4, MAV_0_MODE=2)
    flight.run(3.0)
    assert flight.rates(2.0)["HighresImu"] == pytest.approx(100, abs=2)
    flight.vehicle.parameters.set("MAV_0_MODE", 0)
    flight.vehicle.reboot()
    flight.run(3.0)
    assert flight.rates(2.0)["HighresImu"] == pytest.approx(20, abs=1)

"""Armed, in the air and the system status, by heartbeats and EXTENDED_SYS_STATE."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.dialects import common
from tests.vehicle.telemetry.harness import PX4, with_telemetry


def test_values_of_the_heartbeat():
    async def scenario(harness):
        harness.heartbeat(base_mode=common.MavModeFlag.SAFETY_ARMED, custom_mode=4, system_status=4)
        vehicle = harness.vehicle
        assert vehicle.armed is True
        assert vehicle.mode == "GUIDED"
        assert vehicle.mav_type is common.MavType.QUADROTOR
        assert vehicle.system_status is common.MavState.ACTIVE
        harness.heartbeat(custom_mode=12345)
        assert vehicle.mode is None
        assert vehicle.armed is False

    with_telemetry(scenario)


@pytest.mark.parametrize(("landed_state", "in_air"), [(0, None), (1, False), (2, True), (3, True), (4, True)])
def test_in_the_air_by_extended_sys_state(landed_state, in_air):
    async def scenario(harness):
        harness.heartbeat(PX4)
        harness.receive(common.ExtendedSysState(landed_state=landed_state, vtol_state=4))
        assert harness.vehicle.in_air is in_air
        assert harness.vehicle.landed_state == (landed_state or None)
        assert harness.vehicle.vtol_state is common.MavVtolState.FW

    with_telemetry(scenario)


@pytest.mark.parametrize(
    ("armed", "status", "in_air"),
    [(False, 4, False), (True, 3, False), (True, 4, True), (True, 5, None)],
)
def test_in_the_air_by_ardupilots_heartbeat(armed, status, in_air):
    async def scenario(harness):
        harness.heartbeat(base_mode=armed * common.MavModeFlag.SAFETY_ARMED, system_status=status)
        assert harness.vehicle.in_air is in_air

    with_telemetry(scenario)


def test_an_old_landed_state_gives_way_to_the_heartbeat():
    async def scenario(harness):
        harness.heartbeat(base_mode=common.MavModeFlag.SAFETY_ARMED, system_status=4)
        harness.receive(common.ExtendedSysState(landed_state=1))
        assert harness.vehicle.in_air is False
        await asyncio.sleep(60)
        assert harness.vehicle.in_air is True

    with_telemetry(scenario)


def test_a_rover_is_never_in_the_air():
    async def scenario(harness):
        harness.heartbeat(type=common.MavType.GROUND_ROVER, base_mode=128, system_status=4)
        assert harness.vehicle.in_air is False

    with_telemetry(scenario)


ARMED = common.MavModeFlag.SAFETY_ARMED


@pytest.mark.parametrize(
    ("height", "speed", "throttle", "in_air"),
    [(60, 20, 55, True), (60, 20, 0, True), (60, 1, 40, True), (60, 1, 0, None), (1, 20, 90, None)],
)
@pytest.mark.parametrize("landed_state", [None, common.MavLandedState.UNDEFINED])
def test_a_plane_without_a_landed_state_flies_by_its_height_and_speed(
    height, speed, throttle, in_air, landed_state
):
    async def scenario(harness):
        plane = common.MavType.FIXED_WING
        harness.heartbeat(type=plane, base_mode=ARMED, system_status=common.MavState.CRITICAL)
        if landed_state is not None:
            harness.receive(common.ExtendedSysState(landed_state=landed_state))
        harness.receive(
            common.GlobalPositionInt(relative_alt=height * 1000),
            common.VfrHud(airspeed=speed, groundspeed=speed, throttle=throttle),
        )
        assert harness.vehicle.in_air is in_air
        harness.heartbeat(type=plane, base_mode=0, system_status=common.MavState.CRITICAL)
        assert harness.vehicle.in_air is False

    with_telemetry(scenario)


def test_old_height_and_speed_show_no_flight():
    async def scenario(harness):
        harness.receive(common.GlobalPositionInt(relative_alt=60_000), common.VfrHud(airspeed=20))
        await asyncio.sleep(6)
        harness.heartbeat(type=common.MavType.FIXED_WING, base_mode=ARMED, system_status=5)
        assert harness.vehicle.in_air is None

    with_telemetry(scenario)

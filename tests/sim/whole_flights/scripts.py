"""Flights without a mission: fences, rally points, setpoints, sticks, transitions, message rates, reboots."""

from __future__ import annotations

from collections import Counter
from math import cos, degrees, radians, sin
from typing import TYPE_CHECKING

import pytest

from mavstack.dialects import common
from mavstack.errors import CommandDenied
from mavstack.services.manual_control import ManualInput
from mavstack.services.message_request import DEFAULT, OFF, Interval
from mavstack.services.mission import MissionItem
from mavstack.services.setpoints import AttitudeSetpoint, LocalSetpoint
from mavstack.sim.motion import LocalFrame
from mavstack.sim.vehicle_types import DEFAULT_HOME
from tests.sim.whole_flights.script_runner import ARDUPILOT, CMD, PX4, Pilot, script

if TYPE_CHECKING:
    from mavstack.dialects import Message

_FRAME = LocalFrame(*DEFAULT_HOME[:3])
_ABOVE_HOME = common.MavFrame.GLOBAL_RELATIVE_ALT
VTOL = common.MavVtolState


def at(command: int, north: float, east: float, height: float = 0.0, first: float = 0.0) -> MissionItem:
    latitude, longitude, _ = _FRAME.to_global(north, east, 0.0)
    return MissionItem(int(command), first, 0, 0, 0, latitude, longitude, height, frame=_ABOVE_HOME)


# Fence and return


@script("copter")
async def copter_stays_inside_its_fence(pilot: Pilot) -> None:
    corners = ((25, 30), (25, -30), (-30, -30), (-30, 30))
    inclusion = CMD.NAV_FENCE_POLYGON_VERTEX_INCLUSION
    await pilot.remote.fence.upload([at(inclusion, *corner, first=len(corners)) for corner in corners])
    if not pilot.px4:
        await pilot.remote.params.set("FENCE_ENABLE", 1)
    await pilot.take_off(10)
    farthest = 0.0
    async with pilot.remote.setpoints(rate=10) as stream:
        stream.set(LocalSetpoint(velocity=(4, 0, 0)))
        await pilot.wait(0.5)
        await pilot.set_mode("GUIDED", "OFFBOARD")
        for _ in range(140):
            await pilot.wait(0.1)
            farthest = max(farthest, pilot.truth.north)
    assert 24 < farthest < 35, farthest
    if pilot.px4:
        assert pilot.has_text("Geofence: approaching or outside geofence")
        assert pilot.mode == "HOLD"
        assert pilot.speed < 0.5
    else:
        assert pilot.has_text("Polygon fence breached")
        assert pilot.mode == "RTL"
        await pilot.wait_until(lambda: not pilot.journal.armed, "landed")
        assert pilot.distance_from() < 2
        assert pilot.has_text("Fence breach cleared")


@script("copter")
async def copter_returns_to_the_nearest_rally_point(pilot: Pilot) -> None:
    points = [at(CMD.NAV_RALLY_POINT, 40, 10, 15), at(CMD.NAV_RALLY_POINT, -40, 0, 15)]
    await pilot.remote.rally.upload(points)
    assert (await pilot.remote.rally.download()).items == tuple(points)
    await pilot.take_off(10)
    await pilot.go_to(38, -6, 10)
    await pilot.wait_until(lambda: pilot.distance_from(38, -6) < 2, "arrived")
    await pilot.command(CMD.NAV_RETURN_TO_LAUNCH)
    await pilot.wait_until(lambda: not pilot.journal.armed, "landed", 120)
    assert pilot.distance_from(40, 10) < 1.5
    assert pilot.height < 0.2


@script("copter")
async def copter_returns_home(pilot: Pilot) -> None:
    await pilot.take_off(8)
    await pilot.go_to(30, 25, 8)
    await pilot.wait_until(lambda: pilot.distance_from(30, 25) < 1.5, "arrived")
    await pilot.command(CMD.NAV_RETURN_TO_LAUNCH)
    highest = 0.0
    while pilot.journal.armed:
        highest = max(highest, pilot.height)
        assert pilot.height < 32
        await pilot.wait(0.2)
    assert highest > 14  # RTL climbs first
    assert pilot.distance_from() < 1.5


# Targets


@script("copter")
async def copter_repositions(pilot: Pilot) -> None:
    await pilot.take_off(10)
    await pilot.go_to(20, -15, 14)
    await pilot.wait_until(
        lambda: pilot.distance_from(20, -15) < 0.8 and abs(pilot.height - 14) < 0.8, "arrived", 30
    )
    await pilot.wait(5)
    assert pilot.distance_from(20, -15) < 1.0
    assert pilot.speed < 0.3


@script("plane")
async def plane_circles_a_target_and_home(pilot: Pilot) -> None:
    await pilot.take_off(50)
    await pilot.go_to(200, 150, 60)
    await pilot.wait_until(lambda: 40 < pilot.distance_from(200, 150) < 90, "arrived")
    await pilot.wait(10)
    for _ in range(100):
        await pilot.wait(0.2)
        assert 40 < pilot.distance_from(200, 150) < 100
        assert abs(pilot.height - 60) < 6
    await pilot.command(CMD.NAV_RETURN_TO_LAUNCH)
    await pilot.wait_until(lambda: pilot.distance_from() < 100, "home")
    await pilot.wait_until(lambda: abs(pilot.height - 100) < 8, "at the loiter altitude over home")
    assert pilot.distance_from() < 120


@script("boat")
@script("sub")
async def vehicle_repositions_and_stays(pilot: Pilot) -> None:
    height = -5 if pilot.vehicle.vehicle_type == "sub" else 0
    await pilot.wait_until(lambda: pilot.journal.ready, "ready", 30)
    await pilot.command(CMD.COMPONENT_ARM_DISARM, 1)
    await pilot.go_to(9, -6, height)
    await pilot.wait_until(
        lambda: pilot.distance_from(9, -6) < 2 and abs(pilot.height - height) < 0.7, "arrived"
    )
    await pilot.wait(6)
    assert pilot.distance_from(9, -6) < 2
    assert pilot.speed < 0.3


@script("copter")
async def copter_follows_a_position_setpoint(pilot: Pilot) -> None:
    await pilot.take_off(10)
    await pilot.follow(LocalSetpoint(position=(15, 10, -13), yaw=radians(60)), 14)
    assert pilot.distance_from(15, 10) < 1.0
    assert abs(pilot.height - 13) < 0.8
    assert abs(degrees(pilot.truth.yaw) - 60) < 6


@script("copter")
async def copter_follows_a_velocity_setpoint(pilot: Pilot) -> None:
    await pilot.take_off(10)
    await pilot.follow(LocalSetpoint(velocity=(2, -1, 0)), 8)
    assert abs(pilot.truth.velocity_north - 2) < 0.3
    assert abs(pilot.truth.velocity_east + 1) < 0.3
    assert abs(pilot.height - 10) < 1.5
    await pilot.wait(8)  # the stream has ended
    if pilot.px4:
        assert pilot.mode in ("RETURN", "LAND", "HOLD")
    else:
        assert pilot.mode == "GUIDED"
        assert pilot.speed < 0.3


@script("copter")
async def copter_follows_an_attitude_setpoint(pilot: Pilot) -> None:
    await pilot.take_off(25)
    half = radians(8) / 2
    await pilot.follow(AttitudeSetpoint((cos(half), sin(half), 0, 0), thrust=0.5), 3)
    assert abs(degrees(pilot.truth.roll) - 8) < 2.5
    assert pilot.truth.velocity_east > 1.5
    assert pilot.height > 15


@script("copter", PX4)
async def offboard_requires_a_setpoint_stream(pilot: Pilot) -> None:
    await pilot.take_off(8)
    with pytest.raises(CommandDenied) as refused:
        await pilot.remote.modes.set("OFFBOARD")
    assert refused.value.code == common.MavResult.TEMPORARILY_REJECTED
    async with pilot.remote.setpoints(rate=10) as stream:
        stream.set(LocalSetpoint(velocity=(1, 0, 0)))
        await pilot.wait(1.0)
        await pilot.remote.modes.set("OFFBOARD")
        await pilot.wait(2.0)
        assert pilot.mode == "OFFBOARD"
    ended = pilot.ground.now
    await pilot.wait_until(lambda: pilot.mode != "OFFBOARD", "the stream has ended", 5)
    assert 0.8 < pilot.ground.now - ended < 2.5
    assert pilot.mode == "RETURN"
    await pilot.wait(2.5)
    assert pilot.has_text("Failsafe activated")


@script("copter", PX4)
async def copter_orbits(pilot: Pilot) -> None:
    await pilot.take_off(10)
    latitude, longitude, altitude = _FRAME.to_global(0, 12, -10)
    params = (12, 3, 0, 0, latitude, longitude, altitude)
    await pilot.command(CMD.DO_ORBIT, *params, frame=common.MavFrame.GLOBAL)
    await pilot.wait(8)
    await _assert_circle(pilot, (0, 12), 12)
    assert pilot.mode == "ORBIT"


@script("copter", ARDUPILOT)
async def copter_circles(pilot: Pilot) -> None:
    """CIRCLE: around a point one radius ahead, of ten metres."""
    await pilot.take_off(10)
    centre = 10 * cos(pilot.truth.yaw), 10 * sin(pilot.truth.yaw)
    pilot.vehicle.autopilot.radio.move(3, 1500)  # centred throttle keeps the altitude
    await pilot.set_mode("CIRCLE")
    await pilot.wait(4)
    await _assert_circle(pilot, centre, 10)


async def _assert_circle(pilot: Pilot, centre: tuple[float, float], radius: float) -> None:
    quarters = set()
    for _ in range(300):
        await pilot.wait(0.1)
        assert abs(pilot.distance_from(*centre) - radius) < 1.2
        quarters.add((pilot.truth.north > centre[0], pilot.truth.east > centre[1]))
    assert len(quarters) == 4
    assert abs(pilot.height - 10) < 1.0


# Manual control


@script("copter")
async def sticks_fly_with_altitude_hold(pilot: Pilot) -> None:
    await pilot.take_off(10)
    async with pilot.remote.manual_control(rate=10) as sticks:
        sticks.set(ManualInput(0, 0, 500, 0))
        await pilot.set_mode("ALT_HOLD", "ALTITUDE")
        await pilot.wait(2)
        sticks.set(ManualInput(400, 0, 500, 0))
        await pilot.wait(4)
        assert pilot.truth.velocity_north * cos(pilot.truth.yaw) > 2  # forward
        assert abs(pilot.height - 10) < 1.5
        sticks.set(ManualInput(0, 0, 800, 0))
        before = pilot.height
        await pilot.wait(3)
        assert pilot.height > before + 2
        sticks.set(ManualInput(0, 0, 500, 500))
        before = pilot.truth.yaw
        await pilot.wait(1)
        assert pilot.truth.yaw_rate > 0.2


@script("copter")
async def sticks_fly_with_position_hold(pilot: Pilot) -> None:
    await pilot.take_off(10)
    async with pilot.remote.manual_control(rate=10) as sticks:
        sticks.set(ManualInput(0, 0, 500, 0))
        await pilot.set_mode("POSHOLD", "POSITION")
        await pilot.wait(1)
        sticks.set(ManualInput(0, 500, 500, 0))
        await pilot.wait(4)
        assert pilot.truth.velocity_east > 1
        sticks.set(ManualInput(0, 0, 500, 0))
        await pilot.wait(6)
        place = pilot.truth[:2]
        await pilot.wait(4)
        assert pilot.distance_from(*place) < 0.5
        assert pilot.speed < 0.3
        assert abs(pilot.height - 10) < 1.0


@script("rover")
async def sticks_drive_a_rover(pilot: Pilot) -> None:
    await pilot.wait_until(lambda: pilot.journal.ready, "ready", 30)
    async with pilot.remote.manual_control(rate=10) as sticks:
        sticks.set(ManualInput(0, 0, 0, 0))
        await pilot.wait(0.5)
        await pilot.set_mode("MANUAL", "MANUAL")
        await pilot.command(CMD.COMPONENT_ARM_DISARM, 1)
        sticks.set(ManualInput(0, 0, 400, 0))
        await pilot.wait(3)
        assert pilot.truth.velocity_north > 1
        sticks.set(ManualInput(0, 0, 0, 0))
        await pilot.wait(4)
        assert pilot.speed < 0.3


# A VTOL


@script("vtol")
async def vtol_transitions_and_hovers_again(pilot: Pilot) -> None:
    await pilot.take_off(30)
    if pilot.px4:
        await pilot.wait_until(lambda: pilot.mode == "HOLD", "holding after take-off")
    extended = common.ExtendedSysState
    await pilot.remote.set_message_rate(extended, 5)
    vtol_state = lambda: pilot.journal.latest[extended].vtol_state  # noqa: E731
    await pilot.command(CMD.DO_VTOL_TRANSITION, VTOL.FW)
    await pilot.wait_until(lambda: vtol_state() == VTOL.FW, "forward", 30)
    assert pilot.vehicle.body.airspeed > 13
    await pilot.wait(6)
    assert abs(pilot.height - 30) < 6
    await pilot.command(CMD.DO_VTOL_TRANSITION, VTOL.MC)
    await pilot.wait_until(lambda: vtol_state() == VTOL.MC, "hovering", 30)
    await pilot.wait_until(lambda: pilot.speed < 0.5, "at rest", 20)
    await pilot.wait(3)
    assert pilot.speed < 0.5
    assert abs(pilot.height - 30) < 6


# Rates


@script("copter")
async def message_rates_follow_requests(pilot: Pilot) -> None:
    remote = pilot.remote
    await pilot.wait_until(lambda: pilot.journal.ready, "ready", 30)
    rates = {common.Attitude: 20.0, common.VfrHud: 5.0, common.BatteryStatus: 2.0}
    for kind, rate in rates.items():
        await remote.set_message_rate(kind, rate)
    counted = await _count(pilot, 5.0, *rates)
    for kind, rate in rates.items():
        assert abs(counted[kind] - 5 * rate) <= 2, (kind, counted)
        assert await remote.get_message_interval(kind) == Interval.hertz(rate)
    await remote.set_message_rate(common.Attitude, OFF)
    await remote.set_message_rate(common.VfrHud, DEFAULT)
    counted = await _count(pilot, 5.0, *rates)
    assert counted[common.Attitude] <= 1
    assert counted[common.VfrHud] < 25
    assert counted[common.BatteryStatus] >= 9


async def _count(pilot: Pilot, seconds: float, *kinds: type[Message]) -> Counter[type]:
    counted: Counter[type] = Counter()
    async with pilot.remote.stream(*kinds) as messages:
        await pilot.wait(seconds)
        counted.update(type(message) for message in messages.drain())
    return counted


# A reboot in the air


@script("copter")
async def reboot_in_the_air_causes_a_fall(pilot: Pilot) -> None:
    await pilot.take_off(12)
    reboot = CMD.PREFLIGHT_REBOOT_SHUTDOWN
    with pytest.raises(CommandDenied):
        await pilot.command(reboot, 1)
    assert pilot.height > 11
    if pilot.px4:
        pilot.vehicle.faults.inject("reboot")
    else:
        await pilot.command(reboot, 1, 0, 0, 0, 0, 20190226)
    await pilot.wait_until(lambda: pilot.vehicle.body.on_ground, "on the ground", 10)
    await pilot.wait_until(
        lambda: pilot.journal.ready and not pilot.journal.armed, "ready after the reboot", 40
    )
    assert pilot.vehicle.boots == 2
    assert await pilot.remote.params.get("SYSID_THISMAV" if not pilot.px4 else "MAV_SYS_ID")
    await pilot.command(CMD.COMPONENT_ARM_DISARM, 1)

"""Where a vehicle is, and how fast it moves, at the moment at which a call that goes to a place returns."""

from __future__ import annotations

import asyncio
from math import cos, hypot, sin

import pytest

import mavstack
from mavstack.dialects import common
from mavstack.errors import ActionTimeout, ActionUnsupported, InvalidArgumentError
from mavstack.geodesy import offset_location
from mavstack.services.setpoints import AttitudeSetpoint, LocalSetpoint
from mavstack.services.version import FirmwareVersion
from mavstack.sim.vehicle_types import VehicleType
from mavstack.vehicle.guided_session import STANDING_STILL
from tests.vehicle.failures.scripted_autopilot import run_scenario
from tests.vehicle.world import ALL, ARDUPILOT, PX4, fly, kind_name

CMD = common.MavCmd
#: The messages that change something on a vehicle.
CHANGES = (
    *(common.CommandLong, common.CommandInt, common.SetMode, common.ParamSet),
    *(common.SetPositionTargetLocalNed, common.SetPositionTargetGlobalInt, common.SetAttitudeTarget),
)
COPTER, PLANE, VTOL = VehicleType.COPTER, VehicleType.PLANE, VehicleType.VTOL
ROVER, BOAT, SUB = VehicleType.ROVER, VehicleType.BOAT, VehicleType.SUB
#: The largest distance, difference in height and speed at the end of a call; None: there is no height.
LIMITS = {
    COPTER: (0.6, 0.6, 0.6),
    ROVER: (0.6, None, 0.4),
    BOAT: (1.2, None, 0.5),
    SUB: (0.6, 0.3, 0.3),
    VTOL: (1.1, 1.1, 0.6),
}
#: The radius of the circle that a wing flies around its target, and its tolerance; its tolerance in height.
CIRCLES = {ARDUPILOT: 60.0, PX4: 80.0}
CIRCLE_TOLERANCE, WING_HEIGHT_TOLERANCE = 20.0, 6.0


class Measured:
    """The true motion of a vehicle now, relative to a place in metres north and east of home."""

    def __init__(self, world, north=0.0, east=0.0, height=None):
        truth = world.simulated.body.truth
        self.away = hypot(truth.north - north, truth.east - east)
        self.too_high = None if height is None else -truth.down - height
        self.speed = hypot(truth.velocity_north, truth.velocity_east, truth.velocity_down)
        radial = (truth.north - north) * truth.velocity_north + (truth.east - east) * truth.velocity_east
        ground = hypot(truth.velocity_north, truth.velocity_east)
        #: Metres per second towards the place or away from it.
        self.closing = abs(radial) / max(self.away, 0.1)
        self.ground = ground
        #: Positive while it flies clockwise around the place.
        self.turning = (truth.north - north) * truth.velocity_east - (
            truth.east - east
        ) * truth.velocity_north

    def __repr__(self):
        high = "" if self.too_high is None else f", {self.too_high:+.2f} m high"
        return f"{self.away:.2f} m away{high}, {self.speed:.2f} m/s, radially {self.closing:.2f} m/s"


def place(world, north, east):
    """Degrees of a place in metres from home."""
    return world.simulated.body.frame.to_global(north, east, 0.0)[:2]


def circles(kind):
    """Return whether a vehicle circles the place to which a call goes."""
    return kind[0] is PLANE or kind == (VTOL, ARDUPILOT)


def check(measured, kind):
    if circles(kind):
        assert measured.away == pytest.approx(CIRCLES[kind[1]], abs=CIRCLE_TOLERANCE)
        assert measured.closing < measured.ground * 0.35
        assert measured.too_high is None or abs(measured.too_high) < WING_HEIGHT_TOLERANCE
        return
    away, height, speed = LIMITS[kind[0]]
    assert measured.away < away
    assert height is None or measured.too_high is None or abs(measured.too_high) < height
    assert measured.speed < speed


async def start(vehicle, kind):
    """Take off if the vehicle flies, or leave home if it does not; returns its height."""
    await vehicle.arm()
    if not kind[0].flies:
        return 0.0
    height = 60.0 if kind[0] is not COPTER else 12.0
    await vehicle.takeoff(height)
    return height


@pytest.mark.flight
@pytest.mark.flight_cases(1)
@pytest.mark.parametrize("kind", ALL, ids=kind_name)
def test_a_vehicle_is_where_it_was_sent_when_the_call_returns(kind):
    async def scenario(world, vehicle):
        height = await start(vehicle, kind) + {SUB: -3.0}.get(kind[0], 6.0)
        there = (400.0, 150.0) if circles(kind) else (30.0, 20.0)
        await vehicle.goto(*place(world, *there), height)
        check(Measured(world, *there, height), kind)
        if kind != (SUB, ARDUPILOT):
            await vehicle.rtl()
            if not kind[0].flies or circles(kind):
                check(Measured(world), kind)

    fly(kind, scenario)


@pytest.mark.flight
@pytest.mark.flight_cases(1)
@pytest.mark.parametrize("kind", ALL, ids=kind_name)
def test_a_vehicle_has_moved_when_the_call_returns(kind):
    async def scenario(world, vehicle):
        await start(vehicle, kind)
        truth = world.simulated.body.truth
        north, east, height = truth.north + 8.0, truth.east, -truth.down
        if kind[0].flies or kind[0] is SUB:
            up = {SUB: -1.5, COPTER: 1.5}.get(kind[0], 20.0)
            await vehicle.move(north=8.0, up=up)
            check(Measured(world, north, east, height + up), kind)
        else:
            await vehicle.move(north=8.0)
            check(Measured(world, north, east), kind)

    fly(kind, scenario)


def sent(world):
    """Count the commands, setpoints and parameters that the vehicle receives from now on."""
    received = []
    parser, receive = mavstack.Parser(mavstack.Dialect.load("common")), world.simulated.receive

    def note(port, data):
        received.extend(packet.message for packet in parser.feed(data) if isinstance(packet.message, CHANGES))
        return receive(port, data)

    world.simulated.receive = note
    return received


def commands(received):
    """The names of what was received, without requests for messages."""
    return [
        CMD(message.command).name if hasattr(message, "command") else type(message).__name__
        for message in received
        if getattr(message, "command", None) not in (CMD.REQUEST_MESSAGE, CMD.SET_MESSAGE_INTERVAL)
    ]


SURFACE = [(kind, firmware) for kind, firmware in ALL if kind in (ROVER, BOAT)]


@pytest.mark.flight
@pytest.mark.parametrize("kind", [ROVER, BOAT])
def test_a_rover_arrives_whatever_altitude_its_firmware_reports(kind):
    """ArduRover 4.1 reports the altitude above the sea as the one above home."""

    async def scenario(world, vehicle):
        await vehicle.get_position()
        assert vehicle.position.relative_altitude == pytest.approx(488, abs=3)
        assert (await vehicle.get_version()).flight[:2] == (4, 1)
        await start(vehicle, (kind, ARDUPILOT))
        await vehicle.goto(*place(world, 20.0, 10.0))
        check(Measured(world, 20.0, 10.0), (kind, ARDUPILOT))
        await vehicle.goto(*place(world, 20.0, 30.0), 7.0)
        check(Measured(world, 20.0, 30.0), (kind, ARDUPILOT))
        await vehicle.rtl()
        check(Measured(world), (kind, ARDUPILOT))

    fly((kind, ARDUPILOT), scenario, version=FirmwareVersion(4, 1))


@pytest.mark.parametrize("kind", SURFACE, ids=kind_name)
def test_a_vehicle_without_altitude_does_not_move_up(kind):
    async def scenario(world, vehicle):
        received = sent(world)
        with pytest.raises(ActionUnsupported, match="cannot move up or down: it is a"):
            await vehicle.move(north=5.0, up=2.0)
        assert commands(received) == []

    fly(kind, scenario)


@pytest.mark.flight
@pytest.mark.parametrize(("kind", "name"), [((ROVER, ARDUPILOT), "WP_RADIUS"), ((ROVER, PX4), "NAV_ACC_RAD")])
def test_a_tolerance_below_the_radius_of_the_firmware_is_refused(kind, name):
    async def scenario(world, vehicle):
        await vehicle.arm()
        world.simulated.parameters.set(name, 3.0)
        received, mode = sent(world), vehicle.mode
        with pytest.raises(ActionUnsupported, match=rf"stop within 1 m .*within {name}, 3 m; set that"):
            await vehicle.goto(*place(world, 20.0, 10.0), tolerance=1.0)
        assert commands(received) == []
        assert vehicle.mode == mode
        await vehicle.params.set(name, 0.5)
        await vehicle.goto(*place(world, 20.0, 10.0), tolerance=1.0)
        assert Measured(world, 20.0, 10.0).away < 1.1

    fly(kind, scenario)


@pytest.mark.flight
@pytest.mark.parametrize("kind", [(COPTER, ARDUPILOT), (COPTER, PX4)], ids=kind_name)
@pytest.mark.parametrize("tolerance", [0.3, 4.0])
def test_a_tolerance_that_was_asked_for_is_met(kind, tolerance):
    async def scenario(world, vehicle):
        await start(vehicle, kind)
        await vehicle.goto(*place(world, 30.0, 0.0), tolerance=tolerance)
        assert Measured(world, 30.0).away < tolerance + 0.2
        assert Measured(world, 30.0).speed < LIMITS[COPTER][2]

    fly(kind, scenario)


@pytest.mark.parametrize("tolerance", [0, -1.0, float("nan"), float("inf")])
def test_a_tolerance_is_positive(tolerance):
    async def scenario(world, vehicle):
        received = sent(world)
        calls = (
            vehicle.goto(47.0, 8.0, 20, tolerance=tolerance),
            vehicle.move(1, tolerance=tolerance),
            vehicle.orbit(47.0, 8.0, 20, tolerance=tolerance),
            vehicle.rtl(tolerance=tolerance),
        )
        for call in calls:
            with pytest.raises(InvalidArgumentError, match="tolerance must be positive and finite"):
                await call
        assert commands(received) == []

    fly((COPTER, ARDUPILOT), scenario)


def test_a_vehicle_that_stays_beside_its_target_is_reported():
    async def scenario(harness):
        harness.autopilot.arm()
        await asyncio.sleep(1)
        there = offset_location(47.397742, 8.545594, 1.4, 0.0)
        with pytest.raises(ActionTimeout, match=r"1\.4 m to go; it is 1\.40 m away, the tolerance is 0\.5 m"):
            await harness.vehicle.goto(*there, 20.0)
        await harness.vehicle.goto(*there, 20.0, tolerance=1.5)

    run_scenario(scenario)


def test_a_wing_that_stays_below_its_altitude_is_reported():
    """The calls do not wait for ever while it circles."""

    async def scenario(harness):
        circling = asyncio.create_task(circle(harness.autopilot, radius=80.0))
        harness.autopilot.arm()
        await asyncio.sleep(1)
        with pytest.raises(ActionTimeout, match=r"its altitude is 10\.0 m off, the tolerance is 5 m"):
            await harness.vehicle.goto(47.397742, 8.545594, 30.0)
        await harness.vehicle.goto(47.397742, 8.545594, 30.0, tolerance=12.0)
        with pytest.raises(ActionTimeout, match="it circles at 80 m instead of 40 m"):
            await harness.vehicle.orbit(47.397742, 8.545594, radius=40.0)
        with pytest.raises(ActionTimeout, match="it circles clockwise"):
            await harness.vehicle.orbit(47.397742, 8.545594, radius=-80.0)
        circling.cancel()

    run_scenario(scenario, kind=common.MavType.FIXED_WING)


async def circle(autopilot, radius, *, speed=20.0):
    """Fly around home."""
    angle = 0.0
    while True:
        autopilot.latitude, autopilot.longitude = offset_location(
            47.397742, 8.545594, radius * cos(angle), radius * sin(angle)
        )
        await asyncio.sleep(0.2)
        angle += speed * 0.2 / radius


def test_a_wing_that_passes_has_not_arrived():
    async def scenario(harness):
        harness.autopilot.arm()
        await asyncio.sleep(1)
        call = asyncio.create_task(harness.vehicle.goto(47.397742, 8.545594, 20.0))
        for metres in range(-400, 420, 5):
            harness.autopilot.latitude, harness.autopilot.longitude = offset_location(
                47.397742, 8.545594, metres, 50.0
            )
            await asyncio.sleep(0.25)
        assert not call.done()
        call.cancel()
        call = asyncio.create_task(harness.vehicle.goto(47.397742, 8.545594, 20.0, tolerance=60.0))
        for metres in range(-400, 0, 5):
            harness.autopilot.latitude, harness.autopilot.longitude = offset_location(
                47.397742, 8.545594, metres, 50.0
            )
            await asyncio.sleep(0.25)
        assert call.done()

    run_scenario(scenario, kind=common.MavType.FIXED_WING)


WINGS = [(PLANE, ARDUPILOT), (VTOL, ARDUPILOT), (PLANE, PX4)]
VELOCITY = LocalSetpoint(velocity=(5.0, 0.0, 0.0))
POSITION = LocalSetpoint(position=(100.0, 0.0, -60.0))
ATTITUDE = AttitudeSetpoint((1.0, 0.0, 0.0, 0.0), thrust=0.6)


@pytest.mark.flight
@pytest.mark.parametrize("kind", WINGS, ids=kind_name)
def test_a_wing_refuses_setpoints_that_it_ignores_before_anything_is_sent(kind):
    async def scenario(world, vehicle):
        world.simulated.profile.take_off(world.simulated.autopilot, 60.0)
        await world.wait_until(lambda: -world.simulated.body.truth.down > 50.0)
        await asyncio.sleep(3)
        received, mode = sent(world), vehicle.mode
        ignored = [STANDING_STILL, VELOCITY, *([POSITION] if kind[1] is ARDUPILOT else [])]
        for first in ignored:
            with pytest.raises(
                ActionUnsupported, match=r"cannot follow setpoints of .*goto|cannot follow .*first"
            ):
                async with vehicle.guided(first=first):
                    pytest.fail("it is in its mode")
        await asyncio.sleep(2)
        assert commands(received) == []
        assert vehicle.mode == mode
        assert vehicle.capabilities.setpoints is (None if kind[1] is PX4 else False)
        first = ATTITUDE if kind[1] is ARDUPILOT else POSITION
        async with vehicle.guided(first=first) as guided:
            with pytest.raises(ActionUnsupported):
                guided.velocity(north=5.0)
            guided.attitude(0, 2, 90, 0.6)
            await asyncio.sleep(2)
        assert "SetPositionTargetLocalNed" not in commands(received) or kind[1] is PX4

    fly(kind, scenario)

"""`vehicle.external` with simulated vehicles in virtual time."""

from __future__ import annotations

import asyncio
import sys
from math import inf, nan
from typing import TYPE_CHECKING

import pytest

from mavstack.dialects import common, development
from mavstack.errors import ActionRefused, ActionUnsupported, CommandDenied, InvalidArgumentError
from mavstack.links import MemoryNetwork
from mavstack.node import RemoteComponent
from mavstack.sim.simulation import Simulation
from mavstack.sim.vehicle_types import VehicleType
from mavstack.sim.virtual import run_virtually
from mavstack.vehicle import connect
from tests.sim.autopilot.test_external_vision import VISION
from tests.sim.running import make_ready, running
from tests.vehicle.world import ARDUPILOT, PX4, fly

if TYPE_CHECKING:
    from types import FrameType

    from mavstack.services.command import CommandRequest
    from mavstack.sim.vehicle import SimulatedVehicle
    from mavstack.vehicle import Vehicle
    from tests.vehicle.world import World


def blind(simulated: SimulatedVehicle) -> None:
    """Let a vehicle fly by vision alone."""
    for name, value in VISION[str(simulated.firmware)].items():
        simulated.parameters.set(name, value)
    if simulated.firmware == PX4:
        simulated.body.fail_gps()
    simulated.reboot()


async def see(world: World, vehicle: Vehicle, seconds: float) -> None:
    """Send the truth in the axes of ROS, thirty times a second."""
    for _ in range(round(seconds * 30)):
        truth = world.simulated.body.truth
        vehicle.external.odometry((truth.east, truth.north, -truth.down), quality=90)
        await asyncio.sleep(1 / 30)


@pytest.mark.parametrize("firmware", [ARDUPILOT, PX4])
def test_a_vehicle_flies_by_vision(firmware):
    async def flight(world: World, vehicle: Vehicle) -> None:
        await asyncio.sleep(8)
        status = await vehicle.external.check()
        assert str(status).startswith("the estimator does not use it: nothing was sent")
        other = await vehicle.external.check(parts=frozenset({"position"}))
        assert not any("nothing was sent" in each or " Hz" in each for each in other.reasons)
        await see(world, vehicle, 3)
        reasons = (await vehicle.external.check()).reasons
        assert any("horizontal position" in each or "origin" in each for each in reasons), reasons
        latitude, longitude, altitude = world.simulated.body.frame.to_global(0.0, 0.0, 0.0)
        vehicle.external.set_origin(latitude, longitude, altitude)
        await see(world, vehicle, 8)
        status = await vehicle.external.check()
        assert status.is_used, status
        assert status.rate == pytest.approx(30, abs=1)
        assert status.delay is not None
        assert status.delay < 0.1
        assert status.sent > 200
        assert world.simulated.autopilot.has_position

    fly(("copter", firmware), flight, ready=False, prepare=blind)


def test_each_message_arrives():
    async def flight(world: World, vehicle: Vehicle) -> None:
        seen: list[object] = []
        simulated = world.simulated
        receive = simulated.receive

        def spy(port: object, data: bytes) -> list[object]:
            packets = receive(port, data)
            seen.extend(packet.message for packet in packets)
            return packets

        simulated.receive = spy
        external = vehicle.external
        external.vision((1, 2, 3), (1, 0, 0, 0), velocity=(1, 0, 0), time=1000.5)
        external.mocap((1, 2, 3), (1, 0, 0, 0))
        external.gps(47.0, 8.0, 400.0, velocity=(1, 2, 3), yaw=0.0)
        external.obstacles([1.0, inf, nan])
        external.distance(2.5)
        external.landing_target(1.0, 2.0, 10.0)
        external.follow_target(47.0, 8.0, 400.0, velocity=(1, 2, 3))
        await asyncio.sleep(1)
        names = {type(message).__name__ for message in seen}
        assert names >= {
            "VisionPositionEstimate", "VisionSpeedEstimate", "AttPosMocap", "GpsInput", "ObstacleDistance",
            "DistanceSensor", "LandingTarget", "FollowTarget",
        }  # fmt: skip
        vision = next(each for each in seen if isinstance(each, common.VisionPositionEstimate))
        assert vision.usec == 1_000_500_000
        gps = next(each for each in seen if isinstance(each, common.GpsInput))
        assert (gps.yaw, gps.vd, gps.fix_type, gps.horiz_accuracy) == (36_000, 3.0, 3, 1.0)
        landing = next(each for each in seen if isinstance(each, common.LandingTarget))
        assert (landing.frame, landing.x, landing.position_valid) == (common.MavFrame.BODY_FRD, 1.0, 1)
        for wrong in ((91.0, 0.0, 0.0), (0.0, 0.0, nan)):
            with pytest.raises(InvalidArgumentError):
                external.gps(*wrong)
        with pytest.raises(InvalidArgumentError):
            external.odometry((1, 2, 3), time=-1.0)
        with pytest.raises(InvalidArgumentError, match="a frame is one of NED, ENU"):
            external.odometry((1, 2, 3), frame="XYZ")

    fly(("copter", ARDUPILOT), flight)


def test_an_estimate_wakes_nothing_but_its_own_path():
    """At 50 Hz the Python functions between the call and the link are its cost: 75 of them were too many."""

    async def flight(world: World, vehicle: Vehicle) -> None:
        pose = (1.0, 2.0, 3.0), (1.0, 0.0, 0.0, 0.0)
        vehicle.external.odometry(*pose, velocity=(0.1, 0.2, 0.3))
        calls: list[str] = []

        def note(frame: FrameType, event: str, _: object) -> None:
            if event == "call":
                calls.append(frame.f_code.co_qualname)

        sys.setprofile(note)
        try:
            vehicle.external.odometry(*pose, velocity=(0.1, 0.2, 0.3))
        finally:
            sys.setprofile(None)
        assert "Channel.write" in calls  # it was written, not queued
        assert not [each for each in calls if "timer" in each or "timeout" in each or "events" in each], calls
        assert len(calls) <= 55, calls

    fly(("copter", ARDUPILOT), flight)


def test_the_forms_that_px4_takes(monkeypatch):
    async def flight(world: World, vehicle: Vehicle) -> None:
        sent: list[common.LandingTarget] = []
        await vehicle.wait_for_telemetry("attitude", "local_position")
        monkeypatch.setattr(RemoteComponent, "send", lambda self, message: sent.append(message))
        vehicle.external.landing_target(0.0, 0.0, 10.0)
        down = vehicle.local_position.down
        assert sent[-1].frame == common.MavFrame.LOCAL_NED
        assert sent[-1].z == pytest.approx(down + 10.0, abs=0.5)
        await asyncio.sleep(1)
        world.simulated.cut(True)
        await asyncio.sleep(3)
        vehicle.external.landing_target(0.0, 10.0, 10.0)  # the pose is too old
        assert (sent[-1].position_valid, sent[-1].angle_x) == (0, pytest.approx(0.7854, abs=1e-4))
        world.simulated.cut(False)
        with pytest.raises(ActionUnsupported, match="HIL_GPS from system 1 alone"):
            vehicle.external.gps(47.0, 8.0, 400.0)

    fly(("copter", PX4), flight)


def test_px4_takes_positions_from_its_own_system():
    async def flight() -> tuple[int, int]:
        simulation = Simulation(seed=5)
        simulated = simulation.add("copter", "px4")
        simulated.parameters.set("MAV_USEHILGPS", 1)
        make_ready(simulation)
        network = MemoryNetwork()
        async with (
            running(simulation, network.link()),
            connect(network.link(), system=1, component=191) as node,
        ):
            vehicle = await node.wait_for_vehicle(1)
            for _ in range(20):
                vehicle.external.gps(47.0, 8.0, 400.0, satellites=7)
                await asyncio.sleep(0.1)
            return simulated.body.sensors.gps_satellites, round(simulated.body.sensors.gps_latitude)

    assert run_virtually(flight()) == (7, 47)


@pytest.mark.parametrize("firmware", [ARDUPILOT, PX4])
def test_the_distance_of_a_companion_computer_is_that_of_the_rangefinder(firmware):
    def prepare(simulated: SimulatedVehicle) -> None:
        simulated.parameters.set("RNGFND1_TYPE", 10) if firmware is ARDUPILOT else None
        simulated.reboot()

    async def flight(world: World, vehicle: Vehicle) -> None:
        reported: list[float] = []
        vehicle.component.add_listener(
            common.DistanceSensor, lambda message: reported.append(message.current_distance)
        )
        sensors = world.simulated.body
        for distance in (3.2, 60.0):
            vehicle.external.distance(distance, orientation=0)  # of a sensor that looks forward
            for _ in range(20):
                vehicle.external.distance(distance)
                await asyncio.sleep(0.1)
            assert sensors.sensors.distance == (3.2 if distance < 40 else inf)
        assert 320 in reported
        await asyncio.sleep(1)
        assert sensors.range_report == (inf if firmware is ARDUPILOT else None)

    fly((VehicleType.COPTER, firmware), flight, prepare=prepare)


def test_px4_begins_with_the_wind_of_a_companion_computer():
    async def flight(world: World, vehicle: Vehicle) -> None:
        for wrong in ((-1.0, 0.0), (101.0, 0.0), (1.0, nan)):
            with pytest.raises(InvalidArgumentError):
                await vehicle.external.wind(*wrong)
        with pytest.raises(InvalidArgumentError, match="an accuracy must be finite"):
            await vehicle.external.wind(1.0, 0.0, speed_accuracy=-1.0)
        await vehicle.external.wind(8.0, 450.0, speed_accuracy=1.0)  # from the east
        message = await vehicle.component.request_message(common.WindCov)
        assert (message.wind_x, message.wind_y) == (pytest.approx(0, abs=1e-5), pytest.approx(-8.0))
        await vehicle.arm()
        await vehicle.takeoff(5)
        with pytest.raises(ActionRefused, match="PX4 takes a wind on the ground only"):
            await vehicle.external.wind(8.0, 90.0)

    fly((VehicleType.COPTER, PX4), flight)


@pytest.mark.parametrize("second", [True, False])
def test_the_answer_of_px4s_estimator_counts_not_that_of_its_commander(second):
    async def flight(world: World, vehicle: Vehicle) -> None:
        simulated = world.simulated
        command = development.MavCmd.EXTERNAL_WIND_ESTIMATE

        def refuse(request: CommandRequest) -> common.MavResult:
            if second:
                accepted = common.CommandAck(command=command, target_system=request.source.system)
                simulated.engine.send(accepted, simulated.now, request.source)
            return common.MavResult.UNSUPPORTED

        simulated.services.commands.support(command, refuse)
        if second:
            await vehicle.external.wind(8.0, 90.0)
        else:
            with pytest.raises(CommandDenied):
                await vehicle.external.wind(8.0, 90.0)

    fly((VehicleType.COPTER, PX4), flight)


def test_ardupilot_takes_a_wind():
    async def flight(world: World, vehicle: Vehicle) -> None:
        await vehicle.external.wind(8.0, 90.0, direction_accuracy=5.0)

    fly((VehicleType.COPTER, ARDUPILOT), flight)

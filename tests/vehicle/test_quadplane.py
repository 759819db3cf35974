"""A quadplane of ArduPilot, which calls itself a plane: the first action detects it by its VTOL state."""

from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.errors import ActionUnsupported, CommandDenied
from mavstack.services.message_request.interval import message_id_of
from mavstack.sim.vehicle_types import VehicleType as SimulatedType
from mavstack.vehicle import VehicleType
from tests.vehicle.world import ARDUPILOT, fly


async def airborne(world, vehicle) -> None:
    world.simulated.profile.take_off(world.simulated.autopilot, 40.0)
    await world.wait_until(lambda: vehicle.armed)


def test_first_action_detects_a_quadplane() -> None:
    async def flight(world, vehicle):
        assert vehicle.mav_type == common.MavType.FIXED_WING
        await airborne(world, vehicle)
        await vehicle.hold()
        assert vehicle.vehicle_type is VehicleType.VTOL
        await vehicle.land(wait=False)
        assert world.simulated.autopilot.mode.name == "QLAND"

    fly((SimulatedType.VTOL, ARDUPILOT), flight)


def test_first_action_lands_a_plane_by_its_mission() -> None:
    async def flight(world, vehicle):
        await airborne(world, vehicle)
        with pytest.raises(CommandDenied, match="DO_LAND_START"):
            await vehicle.land(wait=False)
        assert vehicle.vehicle_type is VehicleType.PLANE

    fly((SimulatedType.PLANE, ARDUPILOT), flight)


@pytest.mark.parametrize("state", ["unknown", "undefined"])
def test_a_parameter_identifies_a_quadplane_without_vtol_state(state) -> None:
    """ArduPlane 4.0.7 and 4.1 send EXTENDED_SYS_STATE with an undefined VTOL state."""

    def hide_vtol_state(simulated) -> None:
        stream = simulated.messages._streams.pop(message_id_of(common.ExtendedSysState))
        if state == "undefined":
            simulated.messages._streams[message_id_of(common.ExtendedSysState)] = stream
            stream.produce = lambda now: common.ExtendedSysState()

    async def flight(world, vehicle):
        await airborne(world, vehicle)
        assert vehicle.vehicle_type is VehicleType.PLANE
        await vehicle.hold()
        assert vehicle.vtol_state is None
        assert vehicle.vehicle_type is VehicleType.VTOL
        await vehicle.land(wait=False)
        assert world.simulated.autopilot.mode.name == "QLAND"

    fly((SimulatedType.VTOL, ARDUPILOT), flight, prepare=hide_vtol_state)


def test_a_quadplane_that_hovers_in_guided_arrives_and_does_not_circle():
    """With Q_GUIDED_MODE it flies to its destination on the wing, and hovers there."""

    async def scenario(world, vehicle):
        await vehicle.params.set("Q_GUIDED_MODE", 1)
        await vehicle.arm()
        await vehicle.takeoff(40)
        there = world.simulated.body.frame.to_global(150.0, 60.0, 0.0)[:2]
        for refused in (
            lambda: vehicle.orbit(*there, 40, radius=60),
            lambda: vehicle.goto(*there, 40, radius=60),
        ):
            mode = vehicle.mode
            with pytest.raises(ActionUnsupported, match="hovers at its destination in GUIDED"):
                await refused()
            assert vehicle.mode == mode
        await vehicle.goto(*there, 40)
        truth = world.simulated.body.truth
        assert abs(truth.north - 150.0) < 3
        assert abs(truth.east - 60.0) < 3
        assert vehicle.vtol_state == common.MavVtolState.MC

    fly((SimulatedType.VTOL, ARDUPILOT), scenario)

"""No refused call changes a vehicle: all actions, states and firmwares, with a refusal at each step.

A simulated vehicle denies the n-th request of a call, a command or a parameter. Whatever the call sent before
is reversed: mode, armed state and parameters are as before. For each call n rises until nothing is left to
deny.
"""

from __future__ import annotations

import asyncio
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import pytest

from mavstack.dialects import common
from mavstack.errors import ActionRefused, ActionUnsupported, RemoteError
from mavstack.services.mission import MissionItem
from mavstack.sim.vehicle_types import VehicleType
from tests.vehicle.world import ARDUPILOT, PX4, fly

if TYPE_CHECKING:
    from collections.abc import Callable, Coroutine
    from typing import Any

    from mavstack.vehicle import Vehicle
    from tests.vehicle.world import World

CMD, RESULT = common.MavCmd, common.MavResult
DISARMED, ON_GROUND, FLYING = "disarmed", "armed on the ground", "flying"
KINDS = [
    (VehicleType.COPTER, ARDUPILOT),
    (VehicleType.COPTER, PX4),
    (VehicleType.PLANE, ARDUPILOT),
    (VehicleType.ROVER, ARDUPILOT),
    (VehicleType.PLANE, PX4),
    (VehicleType.ROVER, PX4),
    (VehicleType.VTOL, ARDUPILOT),
    (VehicleType.VTOL, PX4),
    (VehicleType.SUB, ARDUPILOT),
    (VehicleType.BOAT, ARDUPILOT),
]
#: The mode of each vehicle before a call; it differs from the modes that actions enter, where there is one.
MODES = {
    (VehicleType.COPTER, ARDUPILOT): "ALT_HOLD",
    (VehicleType.PLANE, ARDUPILOT): "CRUISE",
    (VehicleType.ROVER, ARDUPILOT): "STEERING",
    (VehicleType.VTOL, ARDUPILOT): "QHOVER",
    (VehicleType.SUB, ARDUPILOT): "ALT_HOLD",
    (VehicleType.BOAT, ARDUPILOT): "STEERING",
}
#: The parameters by which vehicles that stand armed are disarmed after a while.
DISARM_DELAYS = {"DISARM_DELAY": 0, "LAND_DISARMDELAY": 0, "COM_DISARM_PRFLT": -1, "COM_DISARM_LAND": -1}
#: The commands by which calls act.
ACTING = (
    *(CMD.DO_SET_MODE, CMD.DO_SET_STANDARD_MODE, CMD.COMPONENT_ARM_DISARM, CMD.NAV_TAKEOFF, CMD.NAV_LAND),
    *(CMD.NAV_RETURN_TO_LAUNCH, CMD.DO_REPOSITION, CMD.DO_ORBIT, CMD.CONDITION_YAW, CMD.MISSION_START),
    *(CMD.DO_LAND_START, CMD.DO_VTOL_TRANSITION, CMD.DO_FLIGHTTERMINATION),
)
PLACE = (47.3980, 8.5460)


async def through_group(vehicle: Vehicle, name: str) -> None:
    results = await getattr(vehicle.connection.group(vehicle.system), name)(wait=False)
    raise_first(results.errors)


async def group_arm(vehicle: Vehicle) -> None:
    raise_first((await vehicle.connection.group(vehicle.system).arm()).errors)


def raise_first(errors) -> None:
    for error in errors.values():
        raise error


async def guided(vehicle: Vehicle) -> None:
    await vehicle.guided().__aenter__()


ACTIONS: dict[str, Callable[[Vehicle], Coroutine[Any, Any, Any]]] = {
    "arm": lambda vehicle: vehicle.arm(),
    "arm in a group": group_arm,
    "takeoff": lambda vehicle: vehicle.takeoff(12, wait=False),
    "takeoff in a group": lambda vehicle: through_group(vehicle, "takeoff"),
    "land": lambda vehicle: vehicle.land(wait=False),
    "rtl": lambda vehicle: vehicle.rtl(wait=False),
    "rtl in a group": lambda vehicle: through_group(vehicle, "rtl"),
    "hold": lambda vehicle: vehicle.hold(),
    "goto": lambda vehicle: vehicle.goto(*PLACE, 40, wait=False),
    "goto with a heading": lambda vehicle: vehicle.goto(*PLACE, 40, yaw=90, wait=False),
    "move": lambda vehicle: vehicle.move(north=20, wait=False),
    "orbit": lambda vehicle: vehicle.orbit(*PLACE, 40, radius=25, speed=3, wait=False),
    "turn": lambda vehicle: vehicle.set_yaw(90, wait=False),
    "transition": lambda vehicle: vehicle.transition_to_fixed_wing(wait=False),
    "mission start": lambda vehicle: vehicle.mission.start(),
    "mission start that arms": lambda vehicle: vehicle.mission.start(arm=True),
    "mission pause": lambda vehicle: vehicle.mission.pause(),
    "guided": guided,
}
#: The calls that a disarmed vehicle may take.
FOR_DISARMED = frozenset({"arm", "arm in a group", "mission start that arms"})
#: Actions of no vehicle have more steps.
MAX_STEPS = 9


@dataclass
class Denials:
    """Denies one request of a call, counted from 1; 0: none."""

    world: World
    deny: int = 0
    received: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        simulated = self.world.simulated
        server = simulated.commands
        for command in ACTING:
            if command in server.supported:
                server.support(command, self._unless_denied(command, server.handler_of(command)))
        parameters = simulated.parameters._server
        accepts = parameters._refusal

        def refusal(definition, value):
            denied = self._is_denied(definition.name)
            return common.MavParamError.READ_ONLY if denied else accepts(definition, value)

        parameters._refusal = refusal

    def _unless_denied(self, command, handler):
        return lambda request: RESULT.DENIED if self._is_denied(CMD(command).name) else handler(request)

    def _is_denied(self, name: str) -> bool:
        self.received.append(name)
        return len(self.received) == self.deny

    @property
    def denied(self) -> str | None:
        """The request that was denied."""
        return self.received[self.deny - 1] if 0 < self.deny <= len(self.received) else None


def state_of(world: World) -> tuple[str, bool, dict[str, float]]:
    """Return mode, armed state and parameters."""
    autopilot, parameters = world.simulated.autopilot, world.simulated.parameters
    values = {name: definition.value for name, definition in parameters.table._definitions.items()}
    return autopilot.mode.name, autopilot.armed, values


async def enter(world: World, vehicle: Vehicle, state: str, mode: str | None) -> None:
    """Bring a vehicle into a state."""
    simulated = world.simulated
    autopilot = simulated.autopilot
    autopilot.radio.move(3, 1000 if state != FLYING and simulated.vehicle_type.flies else 1500)
    for name, value in DISARM_DELAYS.items():
        if name in simulated.parameters:
            simulated.parameters.set(name, value)
    if state == FLYING:
        simulated.profile.take_off(autopilot, 40.0)
        await world.wait_until(lambda: vehicle.in_air and vehicle.position.relative_altitude > 30)
    elif state == ON_GROUND:
        autopilot.arm(force=True)
    if mode is not None:
        autopilot.enter(number_of(world, mode), "test")
    await world.wait_until(lambda: vehicle.armed is (state != DISARMED))
    await asyncio.sleep(2)


def number_of(world: World, name: str) -> int:
    return next(each.number for each in world.simulated.profile.modes if each.name == name)


async def outcome_of(call: Coroutine[Any, Any, Any]) -> Exception | None:
    try:
        async with asyncio.timeout(60):
            await call
    except (RemoteError, ActionUnsupported, TimeoutError) as error:
        return error
    return None


CASES = [
    (kind, state)
    for state in (DISARMED, ON_GROUND, FLYING)
    for kind in KINDS
    if state != FLYING or kind[0].flies
]
CASES.sort(key=lambda case: KINDS.index(case[0]))


@pytest.mark.flight_cases(8)
@pytest.mark.fast_cases(4)
@pytest.mark.parametrize(("kind", "state"), CASES, ids=[f"{'-'.join(kind)}-{state}" for kind, state in CASES])
def test_a_refused_call_changes_nothing(kind, state):
    async def scenario(world, vehicle):
        frame = common.MavFrame.GLOBAL_RELATIVE_ALT
        items = [MissionItem(CMD.NAV_WAYPOINT, param5=47.398, param6=8.546, param7=40.0, frame=frame)] * 3
        await vehicle.mission.upload([MissionItem(CMD.NAV_TAKEOFF, param7=40.0, frame=frame), *items])
        await enter(world, vehicle, state, MODES.get(kind))
        denials, vehicle_mode = Denials(world), vehicle.mode
        for name, act in ACTIONS.items():
            for step in range(1, MAX_STEPS):
                before = state_of(world)
                denials.deny, denials.received = step, []
                error = await outcome_of(act(vehicle))
                left = getattr(error, "not_restored", ())
                if left:  # the vehicle itself refused the call, and the denial met the restoration
                    assert error.code != RESULT.DENIED, (name, step, denials.received, error)
                    assert left == (f"mode {vehicle_mode} (it is in {vehicle.mode})",)
                    await restore(world, vehicle, before)
                elif error is not None:
                    assert state_of(world) == before, (name, step, denials.received, error)
                if isinstance(error, ActionRefused | ActionUnsupported):
                    assert denials.received == [], (name, error)
                if state == DISARMED and name not in FOR_DISARMED:
                    assert isinstance(error, ActionRefused | ActionUnsupported), (name, error)
                if denials.denied is None:
                    if error is None:
                        await restore(world, vehicle, before)
                    break
            else:
                pytest.fail(f"{name} has more steps: {denials.received}")

    fly(kind, scenario)


async def restore(world: World, vehicle: Vehicle, before: tuple[str, bool, dict[str, float]]) -> None:
    """Bring a vehicle whose call succeeded back into its state."""
    name, armed, values = before
    simulated = world.simulated
    for parameter, value in values.items():
        simulated.parameters.set(parameter, value)
    if not armed:
        simulated.autopilot.disarm("test")
    elif not simulated.autopilot.armed:
        simulated.autopilot.arm(force=True)
    simulated.autopilot.enter(number_of(world, name), "test")
    await world.wait_until(lambda: vehicle.armed is armed)
    await asyncio.sleep(1.5)

"""Arming: modes in which a firmware does not arm are left, modes that start by themselves are refused."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.dialects import common
from mavstack.errors import (
    ActionRefused,
    ActionTimeout,
    CommandDenied,
    CommandTimeout,
    ContactLost,
    HealthTimeout,
)
from mavstack.services.modes import mode_names
from mavstack.sim.vehicle_types import VehicleType
from mavstack.vehicle.firmware.changes import Changes, undone_on_failure
from tests.vehicle.failures.scripted_autopilot import ARDUPILOT as SCRIPTED_ARDUPILOT
from tests.vehicle.failures.scripted_autopilot import CMD, RESULT, run_scenario
from tests.vehicle.failures.scripted_autopilot import PX4 as SCRIPTED_PX4
from tests.vehicle.world import ALL, ARDUPILOT, PX4, fly, kind_name

T = common.MavType
COPTER, PX4_COPTER = (VehicleType.COPTER, ARDUPILOT), (VehicleType.COPTER, PX4)
PLANE, ROVER = (VehicleType.PLANE, ARDUPILOT), (VehicleType.ROVER, ARDUPILOT)
#: The modes in which simulated firmwares do not arm, and the mode that arming enters instead.
LEFT = [
    *((COPTER, mode, "GUIDED") for mode in ("RTL", "LAND", "CIRCLE", "BRAKE", "SMART_RTL")),
    (PLANE, "RTL", "FLY_BY_WIRE_A"),
    (ROVER, "RTL", "HOLD"),
    ((VehicleType.BOAT, ARDUPILOT), "SMART_RTL", "HOLD"),
    ((VehicleType.VTOL, ARDUPILOT), "QLAND", "GUIDED"),
    (PX4_COPTER, "RTL", "LOITER"),
    (PX4_COPTER, "LAND", "LOITER"),
]
#: Modes that start by themselves.
STARTING = [
    (PLANE, "TAKEOFF"),
    (PLANE, "LOITER"),
    (PX4_COPTER, "TAKEOFF"),
    ((VehicleType.PLANE, PX4), "TAKEOFF"),
    ((VehicleType.ROVER, PX4), "OFFBOARD"),
    (ROVER, "CIRCLE"),
]


def name_of(value: object) -> str:
    return kind_name(value) if isinstance(value, tuple) else str(value)


async def enter(world, vehicle, mode):
    """Put a disarmed vehicle into a mode, as a landing or another program does."""
    await vehicle.set_mode(mode)
    await world.wait_until(lambda: vehicle.mode == mode and vehicle.health.ready is not None)


@pytest.mark.fast_cases(5)
@pytest.mark.parametrize(("kind", "mode", "entered"), LEFT, ids=name_of)
def test_arming_leaves_a_mode_in_which_the_firmware_does_not_arm(kind, mode, entered):
    async def scenario(world, vehicle):
        if kind[0] is VehicleType.VTOL:
            await vehicle.params.get("Q_ENABLE")
        await enter(world, vehicle, mode)
        health = vehicle.health
        assert health.ready is False
        assert str(health.problems[0]) == f"its firmware does not arm in mode {mode}"
        assert not any("not armable" in str(problem) for problem in health.problems)
        with pytest.raises(ActionRefused, match=f"does not arm in mode {mode}; change the mode to "):
            await vehicle.arm(keep_mode=True)
        assert (vehicle.mode, vehicle.armed) == (mode, False)
        await vehicle.arm()
        assert (vehicle.mode, vehicle.armed) == (entered, True)

    fly(kind, scenario)


@pytest.mark.fast_cases(4)
@pytest.mark.parametrize("kind", [COPTER, ROVER, PX4_COPTER, PLANE], ids=kind_name)
def test_waiting_for_readiness_leaves_it_too_and_restores_it_in_vain(kind):
    async def scenario(world, vehicle):
        await enter(world, vehicle, "RTL")
        with pytest.raises(HealthTimeout, match="its firmware does not arm in mode RTL"):
            await vehicle.wait_until_ready(keep_mode=True, timeout=10)
        assert vehicle.mode == "RTL"
        world.simulated.faults.inject("compass 120")
        await asyncio.sleep(5)
        with pytest.raises(HealthTimeout):
            await vehicle.wait_until_ready(timeout=10)
        assert vehicle.mode == "RTL"
        world.simulated.faults.inject("compass 0")
        health = await vehicle.wait_until_ready(timeout=60)
        assert health.ready
        assert vehicle.mode != "RTL"
        await vehicle.arm(keep_mode=True)

    fly(kind, scenario)


@pytest.mark.fast_cases(3)
@pytest.mark.parametrize(("kind", "mode"), STARTING, ids=name_of)
def test_arming_where_the_vehicle_would_start_is_refused(kind, mode):
    async def scenario(world, vehicle):
        await enter(world, vehicle, mode)
        with pytest.raises(
            ActionRefused, match=f"in mode {mode} it would start by itself.*allow_flight=True"
        ):
            await vehicle.arm()
        await asyncio.sleep(10)
        assert (vehicle.mode, vehicle.armed) == (mode, False)
        assert not world.simulated.autopilot.armed
        results = await vehicle.connection.group().arm()
        assert isinstance(results.errors[vehicle], ActionRefused)

    fly(kind, scenario)


@pytest.mark.parametrize("kind", [PLANE, PX4_COPTER], ids=kind_name)
def test_a_disarmed_takeoff_sets_no_trap(kind):
    """Real vehicles were launched by the plain arming that followed it."""

    async def scenario(world, vehicle):
        mode = vehicle.mode
        with pytest.raises(ActionRefused, match=r"takeoff to 12 m of 1/1 failed: it is not armed; arm it"):
            await vehicle.takeoff(12)
        assert vehicle.mode == mode
        await vehicle.arm()
        await asyncio.sleep(6)
        assert world.simulated.autopilot.landed

    fly(kind, scenario)


def test_a_flight_that_is_allowed_begins():
    async def scenario(world, vehicle):
        await enter(world, vehicle, "TAKEOFF")
        assert "in mode TAKEOFF it starts by itself when it is armed" in map(str, vehicle.health.warnings)
        await vehicle.arm(allow_flight=True)
        await world.wait_until(lambda: not world.simulated.autopilot.landed)

    fly(PX4_COPTER, scenario)


def test_a_copter_that_may_arm_in_auto_is_armed_there():
    async def scenario(harness):
        harness.autopilot.enter("AUTO")
        await asyncio.sleep(1)
        assert harness.vehicle.health.ready is False
        harness.autopilot.parameters.add("AUTO_OPTIONS", 1.0)
        await harness.vehicle.params.get("AUTO_OPTIONS")
        assert harness.vehicle.health.ready
        with pytest.raises(ActionRefused, match="allow_flight"):
            await harness.vehicle.arm()
        await harness.vehicle.arm(allow_flight=True)
        assert harness.vehicle.mode == "AUTO"

    run_scenario(scenario, autopilot=SCRIPTED_ARDUPILOT, armed=False)


def test_a_refused_arming_restores_the_mode_or_reports_that_it_could_not():
    async def scenario(harness):
        autopilot, vehicle = harness.autopilot, harness.vehicle
        autopilot.enter("RTL")
        await asyncio.sleep(0.5)
        autopilot.refuse(CMD.COMPONENT_ARM_DISARM)
        with pytest.raises(CommandDenied) as denied:
            await vehicle.arm()
        assert vehicle.mode == "RTL"
        assert denied.value.not_restored == ()
        autopilot.on_refusal = lambda: autopilot.refuse(CMD.DO_SET_MODE, result=RESULT.FAILED)
        with pytest.raises(CommandDenied) as denied:
            await vehicle.arm()
        assert vehicle.mode == "GUIDED"
        assert str(denied.value).endswith("DENIED; not restored: mode RTL (it is in GUIDED)")

    run_scenario(scenario, autopilot=SCRIPTED_ARDUPILOT, armed=False)


def acknowledges_arming(autopilot, *, arms=False, silent=False):
    """Let the scripted autopilot accept arming without a heartbeat that confirms it."""

    def handle(request):
        if request.command.param1 and arms:
            asyncio.get_running_loop().call_later(2.0, autopilot.arm, True)
        elif not request.command.param1:
            autopilot.arm(False)
        if silent:
            asyncio.get_running_loop().call_later(0.5, setattr, autopilot, "silent", True)
        return RESULT.ACCEPTED

    autopilot.commands.server.support(CMD.COMPONENT_ARM_DISARM, handle)


@pytest.mark.parametrize("timeout", [None, 5.0])
def test_an_arming_that_no_heartbeat_confirms_is_reversed(timeout):
    async def scenario(harness):
        autopilot, vehicle = harness.autopilot, harness.vehicle
        autopilot.enter("RTL")
        await asyncio.sleep(0.5)
        acknowledges_arming(autopilot)
        with pytest.raises(ActionTimeout) as failed:
            await vehicle.arm(timeout=timeout)
        assert vehicle.mode == "RTL"
        assert failed.value.not_restored == ()
        disarming = [each for each in autopilot.received if getattr(each, "command", None) == 400]
        assert [each.param1 for each in disarming] == [1.0, 0.0]

    run_scenario(scenario, autopilot=SCRIPTED_ARDUPILOT, armed=False)


def test_an_arming_that_comes_late_is_reversed_too():
    async def scenario(harness):
        autopilot, vehicle = harness.autopilot, harness.vehicle
        acknowledges_arming(autopilot, arms=True)
        with pytest.raises(ActionTimeout, match=r"not done in 1\.5 s$"):
            await vehicle.arm(timeout=1.5)
        assert not vehicle.armed
        await asyncio.sleep(3)

    run_scenario(scenario, autopilot=SCRIPTED_ARDUPILOT, armed=False)


def test_a_vehicle_that_falls_silent_while_it_arms_names_what_remains():
    async def scenario(harness):
        autopilot, vehicle = harness.autopilot, harness.vehicle
        autopilot.enter("RTL")
        await asyncio.sleep(0.5)
        acknowledges_arming(autopilot, silent=True)
        begun = harness.connection.now()
        with pytest.raises(ContactLost) as lost:
            await vehicle.arm()
        assert harness.connection.now() - begun < 12
        assert lost.value.not_restored == ("disarmed (it may be armed)", "mode RTL (it is in GUIDED)")

    run_scenario(scenario, autopilot=SCRIPTED_ARDUPILOT, armed=False)


def test_a_lost_acknowledgement_of_arming_names_that_it_is_armed():
    async def scenario(harness):
        autopilot, vehicle = harness.autopilot, harness.vehicle

        def arm_without_an_end(request):
            autopilot.arm(True)
            return RESULT.IN_PROGRESS

        autopilot.commands.server.support(CMD.COMPONENT_ARM_DISARM, arm_without_an_end)
        with pytest.raises(CommandTimeout, match=r"not restored: disarmed \(it is armed\)$"):
            await vehicle.arm()

    run_scenario(scenario, autopilot=SCRIPTED_ARDUPILOT, armed=False)


def test_a_timeout_around_the_steps_names_what_remains():
    async def scenario(harness):
        autopilot, vehicle = harness.autopilot, harness.vehicle
        autopilot.enter("RTL")
        await asyncio.sleep(0.5)
        acknowledges_arming(autopilot)
        asyncio.get_running_loop().call_later(3, autopilot.refuse, CMD.DO_SET_MODE)
        with pytest.raises(ActionTimeout) as late:
            await vehicle.arm(timeout=5.0)
        assert vehicle.mode == "GUIDED"
        assert late.value.not_restored == ("mode RTL (it is in GUIDED)",)

    run_scenario(scenario, autopilot=SCRIPTED_ARDUPILOT, armed=False)


def test_a_mode_that_a_pilot_chose_meanwhile_is_kept():
    async def scenario(harness):
        autopilot, vehicle = harness.autopilot, harness.vehicle
        changes = Changes(vehicle)

        async def fail_after_a_change_of_mode() -> None:
            async with undone_on_failure(changes):
                await changes.set_mode("GUIDED")
                autopilot.enter("STABILIZE")
                autopilot.refuse(CMD.MISSION_START)
                await asyncio.sleep(0.5)
                await vehicle.command(CMD.MISSION_START)

        with pytest.raises(CommandDenied):
            await fail_after_a_change_of_mode()
        assert vehicle.mode == "STABILIZE"

    run_scenario(scenario, autopilot=SCRIPTED_ARDUPILOT)


def test_a_mode_after_a_lost_acknowledgement_is_kept_and_named():
    """The vehicle may return home because its battery is low: what it does is not reversed."""

    async def scenario(harness):
        autopilot, vehicle = harness.autopilot, harness.vehicle

        def enter_without_an_end(request):
            autopilot.enter("RTL")
            return RESULT.IN_PROGRESS

        autopilot.commands.server.support(CMD.NAV_RETURN_TO_LAUNCH, enter_without_an_end)
        with pytest.raises(CommandTimeout, match=r"not restored: mode LOITER \(it is in RTL\)$"):
            await vehicle.rtl()
        assert vehicle.mode == "RTL"

    run_scenario(scenario)


def test_a_cancelled_call_is_reversed():
    async def scenario(harness):
        autopilot, vehicle = harness.autopilot, harness.vehicle
        autopilot.commands.server.support(CMD.NAV_TAKEOFF, lambda request: RESULT.IN_PROGRESS)
        autopilot.land()
        await asyncio.sleep(1)
        rising = asyncio.create_task(vehicle.takeoff(10))
        await asyncio.sleep(1.5)
        assert vehicle.mode == "GUIDED"
        rising.cancel()
        await asyncio.gather(rising, return_exceptions=True)
        assert rising.cancelled()
        assert vehicle.mode == "LOITER"

    run_scenario(scenario, autopilot=SCRIPTED_ARDUPILOT)


@pytest.mark.parametrize("kind", ALL, ids=kind_name)
def test_every_type_waits_armed_in_a_mode_of_its_own(kind):
    async def scenario(world, vehicle):
        firmware = vehicle.firmware
        mode = firmware.waiting_mode
        await vehicle.set_mode(mode)
        assert firmware.allows_arming(mode)
        assert not firmware.starts_by_itself(mode)

    fly(kind, scenario)


@pytest.mark.parametrize(
    ("autopilot", "kind", "mode"),
    [
        *((SCRIPTED_ARDUPILOT, T.QUADROTOR, mode) for mode in ("AVOID_ADSB", "SYSTEMID", "AUTOROTATE")),
        *((SCRIPTED_ARDUPILOT, T.QUADROTOR, mode) for mode in ("BRAKE", "CIRCLE", "FLIP", "FOLLOW")),
        *((SCRIPTED_ARDUPILOT, T.VTOL_TILTROTOR, mode) for mode in ("QLAND", "QRTL", "RTL")),
        *((SCRIPTED_ARDUPILOT, T.GROUND_ROVER, mode) for mode in ("RTL", "SMART_RTL")),
        *((SCRIPTED_PX4, T.QUADROTOR, mode) for mode in ("FOLLOW_TARGET", "ORBIT", "PRECLAND")),
    ],
)
def test_health_reports_that_the_firmware_does_not_arm(autopilot, kind, mode):
    async def scenario(harness):
        harness.autopilot.arm(False)
        harness.autopilot.enter(mode)
        await asyncio.sleep(1)
        health = harness.vehicle.health
        assert health.ready is False
        assert str(health.problems[0]) == f"its firmware does not arm in mode {mode}"

    run_scenario(scenario, autopilot=autopilot, kind=kind)


@pytest.mark.parametrize(
    ("mode", "arms"),
    [("FBWA", False), ("QLOITER", True), ("QLAND", False), ("GUIDED", True), ("AUTO", True), ("RTL", False)],
)
def test_a_quadplane_may_arm_in_its_own_modes_only(mode, arms):
    """Bit 18 of Q_OPTIONS; AUTO starts by itself, and GUIDED does not look at the bit."""

    async def scenario(harness):
        harness.autopilot.parameters.add("Q_OPTIONS", float(1 << 18))
        await harness.vehicle.params.get("Q_OPTIONS")
        assert harness.vehicle.firmware.allows_arming(mode) is arms

    run_scenario(scenario, autopilot=SCRIPTED_ARDUPILOT, kind=T.VTOL_TILTROTOR)


@pytest.mark.parametrize("kind", ALL, ids=kind_name)
def test_the_simulated_firmware_arms_in_the_same_modes(kind):
    async def scenario(world, vehicle):
        info = vehicle.component.info
        for mode in world.simulated.profile.modes:
            name = mode_names(info.autopilot, info.type).get(mode.number, mode.name)
            assert vehicle.firmware.allows_arming(name) is mode.may_arm, name

    fly(kind, scenario)

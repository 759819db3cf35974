"""The failure table of outputs, region of interest, calibrations and the vehicle's own commands."""

from __future__ import annotations

from contextlib import suppress
from typing import Any

from mavstack.dialects import ardupilotmega, common
from mavstack.errors import ActionTimeout, InvalidStateError, MessageTimeout
from tests.vehicle.failures.rows import PLACE, Call, Do, command
from tests.vehicle.failures.scripted_autopilot import ARDUPILOT, CMD, RESULT, ScriptedHarness

NOT_WAITED = "it does not wait for the effect"
NO_STATUS = "a vehicle that sends no WINCH_STATUS is not waited for"
SET_EKF_SOURCE_SET = ardupilotmega.MavCmd.SET_EKF_SOURCE_SET
ON_ARDUPILOT = {"autopilot": ARDUPILOT}
ON_VTOL = {"kind": common.MavType.VTOL_TAILSITTER_QUADROTOR}


async def with_home(harness: ScriptedHarness) -> None:
    await harness.vehicle.get_home()


async def start_calibration(harness: ScriptedHarness) -> None:
    async with harness.vehicle.calibration.start("level"):
        pass


async def iterate_calibration(harness: ScriptedHarness) -> None:
    async with harness.vehicle.calibration.start("level") as session:
        async for _ in session:
            pass


async def confirm_nothing(harness: ScriptedHarness) -> None:
    with suppress(InvalidStateError):
        await harness.vehicle.calibration.start("level").confirm()


def output(name: str, do: Do, number: int, **more: Any) -> Call:
    """Return the row of a call that sends a command, with one code: it has no rules of its own for others."""
    return command(name, do, number, codes=(RESULT.TEMPORARILY_REJECTED,), **more)


OUTPUT_CALLS = [
    output(
        "Vehicle.command",
        lambda h: h.vehicle.command(CMD.DO_SET_HOME, 1),
        CMD.DO_SET_HOME,
        why_not=NOT_WAITED,
    ),
    Call(
        "Vehicle.get_version",
        lambda h: h.vehicle.get_version(),
        silent=MessageTimeout,
        why_not="a refused request is repeated as the legacy command",
    ),
    output(
        "Vehicle.set_ekf_source",
        lambda h: h.vehicle.set_ekf_source(2),
        SET_EKF_SOURCE_SET,
        options=ON_ARDUPILOT,
        why_not=NOT_WAITED,
    ),
    output(
        "Vehicle.transition_to_fixed_wing",
        lambda h: h.vehicle.transition_to_fixed_wing(),
        CMD.DO_VTOL_TRANSITION,
        stuck=(ActionTimeout, "transition to fixed-wing flight of 1/1 failed: no progress for 60 s"),
        options=ON_VTOL,
    ),
    output(
        "Vehicle.transition_to_multicopter",
        lambda h: h.vehicle.transition_to_multicopter(),
        CMD.DO_VTOL_TRANSITION,
        stuck=(ActionTimeout, "transition to multicopter flight of 1/1 failed: no progress for 60 s"),
        options=ON_VTOL,
    ),
    output(
        "Vehicle.terminate",
        lambda h: h.vehicle.terminate(),
        CMD.DO_FLIGHTTERMINATION,
        stuck=(ActionTimeout, "flight termination of 1/1 failed: no progress for 10 s"),
    ),
    output(
        "Actuators.set_servo",
        lambda h: h.vehicle.actuators.set_servo(9, 1500),
        CMD.DO_SET_SERVO,
        options=ON_ARDUPILOT,
        why_not=NOT_WAITED,
    ),
    output(
        "Actuators.set_relay",
        lambda h: h.vehicle.actuators.set_relay(0, True),
        CMD.DO_SET_RELAY,
        options=ON_ARDUPILOT,
        why_not=NOT_WAITED,
    ),
    output(
        "Actuators.set_actuator",
        lambda h: h.vehicle.actuators.set_actuator(1, 0.5),
        CMD.DO_SET_ACTUATOR,
        why_not=NOT_WAITED,
    ),
    output(
        "Actuators.test_motor",
        lambda h: h.vehicle.actuators.test_motor(1, duration=8),
        CMD.ACTUATOR_TEST,
        armed=False,
        why_not="nothing reports whether a motor runs",
    ),
    output("Actuators.grip", lambda h: h.vehicle.actuators.grip(), CMD.DO_GRIPPER, why_not=NOT_WAITED),
    output("Actuators.release", lambda h: h.vehicle.actuators.release(), CMD.DO_GRIPPER, why_not=NOT_WAITED),
    output("Actuators.unwind", lambda h: h.vehicle.actuators.unwind(5), CMD.DO_WINCH, why_not=NO_STATUS),
    output(
        "Actuators.run_winch", lambda h: h.vehicle.actuators.run_winch(1), CMD.DO_WINCH, why_not=NO_STATUS
    ),
    output(
        "Actuators.relax_winch", lambda h: h.vehicle.actuators.relax_winch(), CMD.DO_WINCH, why_not=NOT_WAITED
    ),
    output(
        "Calibration.run",
        lambda h: h.vehicle.calibration.run("gyroscope"),
        CMD.PREFLIGHT_CALIBRATION,
        stuck=(ActionTimeout, "gyroscope calibration of 1/1 failed: no progress for 30 s"),
        armed=False,
    ),
    output(
        "Calibration.cancel",
        lambda h: h.vehicle.calibration.cancel("compass"),
        ardupilotmega.MavCmd.DO_CANCEL_MAG_CAL,
        options=ON_ARDUPILOT,
        why_not=NOT_WAITED,
    ),
    Call("CalibrationSession.__aenter__", start_calibration, silent=None, why_not="the iteration raises"),
    output(
        "CalibrationSession.__anext__",
        iterate_calibration,
        CMD.PREFLIGHT_CALIBRATION,
        stuck=(ActionTimeout, "level calibration of 1/1 failed: no progress for 30 s"),
        armed=False,
    ),
    Call("CalibrationSession.__aexit__", start_calibration, silent=None, why_not="a refusal is ignored"),
    Call("CalibrationSession.confirm", confirm_nothing, silent=None, why_not="it sends no request"),
    output(
        "RegionOfInterest.set_location",
        lambda h: h.vehicle.roi.set_location(*PLACE),
        CMD.DO_SET_ROI_LOCATION,
        before=with_home,
        why_not=NOT_WAITED,
    ),
    output(
        "RegionOfInterest.set_next_waypoint",
        lambda h: h.vehicle.roi.set_next_waypoint(pitch=-30),
        CMD.DO_SET_ROI_WPNEXT_OFFSET,
        why_not=NOT_WAITED,
    ),
    output(
        "RegionOfInterest.clear", lambda h: h.vehicle.roi.clear(), CMD.DO_SET_ROI_NONE, why_not=NOT_WAITED
    ),
]

"""Modes, identity, texts and flight parameters of ArduPilot's firmwares."""

from __future__ import annotations

from math import inf

import pytest

from mavstack.dialects import ardupilotmega, common
from mavstack.services.modes import mode_names
from mavstack.services.modes.names import mode_number
from mavstack.services.version import AutopilotVersion
from mavstack.sim.ardupilot.modes import MODES
from mavstack.sim.vehicle_types import Firmware, VehicleType

from .harness import CMD, RESULT, ArdupilotHarness

WANTED = {
    "copter": "STABILIZE ACRO ALT_HOLD AUTO GUIDED LOITER RTL CIRCLE LAND POSHOLD BRAKE SMART_RTL AUTO_RTL",
    "plane": "MANUAL CIRCLE STABILIZE TRAINING ACRO FBWA FBWB CRUISE AUTO RTL LOITER TAKEOFF GUIDED",
    "vtol": "QSTABILIZE QHOVER QLOITER QLAND QRTL FBWA AUTO RTL GUIDED",
    "rover": "MANUAL ACRO STEERING HOLD LOITER AUTO RTL SMART_RTL GUIDED",
    "boat": "MANUAL ACRO STEERING HOLD LOITER AUTO RTL SMART_RTL GUIDED",
    "sub": "STABILIZE ACRO ALT_HOLD AUTO GUIDED CIRCLE SURFACE POSHOLD MANUAL",
}


@pytest.mark.parametrize("kind", list(VehicleType))
def test_modes_have_the_numbers_that_their_names_mean_elsewhere(kind: VehicleType) -> None:
    autopilot = Firmware.ARDUPILOT.mav_autopilot
    names = {mode.name for mode in MODES[kind]}
    assert names >= set(WANTED[kind].split())
    for mode in MODES[kind]:
        assert mode_number(autopilot, kind.mav_type, mode.name) == mode.number
        assert mode.number in mode_names(autopilot, kind.mav_type)


@pytest.mark.parametrize("kind", list(VehicleType))
def test_every_mode_can_be_entered_and_flown(kind: VehicleType) -> None:
    bench = ArdupilotHarness(kind)
    bench.lift(40.0)
    for mode in MODES[kind]:
        if mode.name in ("AUTO", "AUTO_RTL"):
            continue  # the mission's tests
        bench.set_mode("GUIDED")
        if kind in ("copter", "vtol"):
            bench.vehicle.body.place(0.0, 0.0, -40.0, 0.0)
        assert bench.set_mode(mode.name) == RESULT.ACCEPTED, mode.name
        bench.run(1)
        heartbeat = [message for message in bench.received if isinstance(message, common.Heartbeat)][-1]
        assert heartbeat.custom_mode == mode.number
        assert heartbeat.base_mode & common.MavModeFlag.SAFETY_ARMED


def test_a_mode_that_needs_a_position_is_refused_without() -> None:
    bench = ArdupilotHarness("copter")
    bench.lift()
    bench.set_mode("ALT_HOLD")
    bench.vehicle.body.fail_gps(True)
    bench.run_until(lambda: not bench.autopilot.has_position)
    assert bench.set_mode("LOITER") == RESULT.FAILED
    assert bench.texts[-1] == "Mode change to LOITER failed: requires position"
    assert bench.command(CMD.NAV_RETURN_TO_LAUNCH) == RESULT.FAILED
    assert "Mode change to RTL failed: requires position" in bench.texts


def test_ground_stations_can_be_kept_from_modes() -> None:
    bench = ArdupilotHarness("copter")
    bench.vehicle.parameters.set("FLTMODE_GCSBLOCK", 1 << 4)
    assert bench.set_mode("GUIDED") == RESULT.FAILED
    assert bench.texts[-1].startswith("Mode change to GUIDED failed: GCS entry disabled")
    assert bench.set_mode("LOITER") == RESULT.ACCEPTED


def test_auto_with_nothing_to_fly_is_refused_when_armed() -> None:
    bench = ArdupilotHarness("copter")
    bench.accepted(CMD.COMPONENT_ARM_DISARM, 1)
    assert bench.set_mode("AUTO") == RESULT.FAILED
    assert bench.texts[-1] == "Mode change to AUTO failed: init failed"


@pytest.mark.parametrize("kind", list(VehicleType))
def test_who_it_is(kind: VehicleType) -> None:
    bench = ArdupilotHarness(kind)
    bench.accepted(CMD.REQUEST_MESSAGE, common.AutopilotVersion.__mavlink_row__[0])
    told = next(message for message in bench.received if isinstance(message, common.AutopilotVersion))
    version = AutopilotVersion.read(told)
    assert (version.flight.major, version.flight.minor) == (4, 6)
    assert version.can(common.MavProtocolCapability.FTP | common.MavProtocolCapability.COMMAND_INT)
    assert len(version.git_hash) == 8
    bench.send(common.ParamRequestList(target_system=1, target_component=1))
    firmware = {"copter": "ArduCopter", "plane": "ArduPlane", "vtol": "ArduPlane", "sub": "ArduSub"}.get(
        kind, "ArduRover"
    )
    assert any(text.startswith(f"{firmware} V4.6.") for text in bench.texts)


def test_what_is_said_at_the_start_and_when_gps_comes_and_goes() -> None:
    bench = ArdupilotHarness("copter")
    for text in ("ArduPilot Ready", "EKF3 IMU0 is using GPS", "Field Elevation Set: 488m"):
        assert text in bench.texts
    bench.vehicle.body.fail_gps(True)
    bench.run_until(lambda: "EKF3 IMU0 stopped aiding" in bench.texts)
    bench.vehicle.body.fail_gps(False)
    bench.run_until(lambda: bench.texts.count("EKF3 IMU0 is using GPS") == 2)


def test_figures_follow_their_parameters() -> None:
    bench = ArdupilotHarness("copter")
    parameters, flight_parameters = bench.vehicle.parameters, bench.autopilot.flight_parameters
    for name, value in (("WPNAV_SPEED", 750), ("RTL_ALT", 3000), ("LAND_SPEED", 70), ("RTL_ALT_FINAL", 500)):
        parameters.set(name, value)
    assert (
        flight_parameters.cruise_speed,
        flight_parameters.return_altitude,
        flight_parameters.land_speed,
    ) == pytest.approx((7.5, 30.0, 0.7))
    assert flight_parameters.return_loiter_time == inf
    for name in ("WPNAV_SPEED", "RTL_ALT", "WPNAV_RADIUS", "CIRCLE_RADIUS", "GUID_TIMEOUT"):
        parameters.set(name, -5)
        assert flight_parameters.cruise_speed > 0
        assert flight_parameters.acceptance_radius > 0
        assert flight_parameters.return_altitude >= 0
    parameters.set("ANGLE_MAX", 1500)
    assert bench.vehicle.body.limits.tilt == pytest.approx(0.2618, abs=1e-3)


def test_a_reboot_is_answered_and_the_vehicle_comes_back() -> None:
    bench = ArdupilotHarness("copter")
    bench.accepted(CMD.PREFLIGHT_REBOOT_SHUTDOWN, 1)
    bench.received.clear()
    bench.run(5)
    assert "ArduPilot Ready" in bench.texts
    assert bench.vehicle.uptime < 6
    assert isinstance(
        next(message for message in bench.received if isinstance(message, common.Heartbeat)), common.Heartbeat
    )
    assert bench.autopilot.mode.number == ardupilotmega.CopterMode.STABILIZE

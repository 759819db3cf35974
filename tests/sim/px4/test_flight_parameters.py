"""PX4's flight parameters: finite and flyable on every type, and set by parameters."""

from __future__ import annotations

from math import inf, isnan, radians

import pytest

from mavstack.sim.autopilot.flight_parameters import FlightParameters
from mavstack.sim.parameters import Parameters
from mavstack.sim.px4.flight_parameters import (
    FixedWingFlightParameters,
    MulticopterFlightParameters,
    Px4FlightParameters,
    flight_parameters_of,
)
from mavstack.sim.px4.identity import CAPABILITIES
from mavstack.sim.vehicle_types import Firmware, VehicleType
from tests.sim.px4.harness import FIELD_ALTITUDE, Px4Harness

NAMES = sorted(FlightParameters.__annotations__.keys() - {"limits"})


def flight_parameters(vehicle_type: VehicleType) -> Px4FlightParameters:
    vehicle = Px4Harness(vehicle_type.value, ready=False).vehicle
    return flight_parameters_of(vehicle)


@pytest.mark.parametrize("vehicle_type", list(VehicleType))
def test_every_flight_parameter_is_valid(vehicle_type: VehicleType) -> None:
    actual = flight_parameters(vehicle_type)
    for name in NAMES:
        value = getattr(actual, name)
        if name == "setpoint_frames":
            assert len(value) == 2
        elif name != "thrust_is_climb":
            assert isinstance(value, float | int), name
            assert not isnan(value), name
    assert actual.cruise_speed > 0.4
    assert actual.acceptance_radius > 0.2


@pytest.mark.parametrize(
    ("parameter", "value", "name", "expected"),
    [
        ("MIS_TAKEOFF_ALT", 7.0, "takeoff_altitude", 7.0),
        ("MPC_XY_CRUISE", 4.0, "cruise_speed", 4.0),
        ("MPC_Z_V_AUTO_UP", 2.0, "climb_speed", 2.0),
        ("MPC_Z_V_AUTO_DN", 1.0, "sink_speed", 1.0),
        ("MPC_LAND_SPEED", 0.6, "land_speed", 0.6),
        ("NAV_ACC_RAD", 3.0, "acceptance_radius", 3.0),
        ("NAV_LOITER_RAD", 70.0, "loiter_radius", 70.0),
        ("RTL_RETURN_ALT", 45.0, "return_altitude", 45.0),
        ("RTL_DESCEND_ALT", 15.0, "return_descend_altitude", 15.0),
        ("RTL_LAND_DELAY", 4.0, "return_loiter_time", 4.0),
        ("RTL_LAND_DELAY", -1.0, "return_loiter_time", inf),
        ("RTL_CONE_ANG", 0, "return_cone_slope", 0.0),
        ("RTL_CONE_ANG", 45, "return_cone_slope", 1.0),
        ("COM_OF_LOSS_T", 2.0, "setpoint_timeout", 2.0),
        ("MPC_MAN_TILT_MAX", 20.0, "lean_angle", radians(20)),
        ("MPC_MAN_Y_MAX", 90.0, "pilot_yaw_rate", radians(90)),
        ("MPC_LAND_ALT2", 6.0, "land_slow_altitude", 6.0),
    ],
)
def test_multicopter_flight_parameters(parameter: str, value: float, name: str, expected: float) -> None:
    parameters = Parameters(Firmware.PX4, VehicleType.COPTER)
    actual = MulticopterFlightParameters(parameters)
    parameters.set(parameter, value)
    assert getattr(actual, name) == pytest.approx(expected)


@pytest.mark.parametrize(
    ("parameter", "value", "name", "expected"),
    [
        ("FW_AIRSPD_TRIM", 16.0, "cruise_speed", 16.0),
        ("FW_T_CLMB_R_SP", 2.5, "climb_speed", 2.5),
        ("FW_T_SINK_R_SP", 1.5, "sink_speed", 1.5),
        ("FW_LND_ANG", 8.0, "glide_slope", 0.1405),
        ("FW_MAN_R_MAX", 30.0, "lean_angle", radians(30)),
    ],
)
def test_fixed_wing_flight_parameters(parameter: str, value: float, name: str, expected: float) -> None:
    parameters = Parameters(Firmware.PX4, VehicleType.PLANE)
    actual = FixedWingFlightParameters(parameters)
    parameters.set(parameter, value)
    assert getattr(actual, name) == pytest.approx(expected, rel=1e-3)


@pytest.mark.nightly
def test_vtol_flight_parameters_follow_the_transition() -> None:
    harness = Px4Harness("vtol").take_off(40)
    assert harness.autopilot.flight_parameters.cruise_speed == 5.0
    harness.vehicle.body.transition_to(True)
    harness.run(15.0)
    assert harness.autopilot.flight_parameters.cruise_speed == 20.0


def test_limits_of_the_body_follow_parameters() -> None:
    harness = Px4Harness()
    assert harness.vehicle.body.limits.acceleration == 3.0
    harness.vehicle.parameters.set("MPC_ACC_HOR", 2.0)
    harness.vehicle.parameters.set("MPC_TILTMAX_AIR", 25.0)
    assert harness.vehicle.body.limits.acceleration == 2.0
    assert harness.vehicle.body.limits.tilt == pytest.approx(radians(25))


def test_identity() -> None:
    from mavstack.dialects import common

    harness = Px4Harness()
    (version,) = harness.request(common.AutopilotVersion)[:1]
    assert version.capabilities == CAPABILITIES == 59647
    assert version.flight_sw_version == 0x011000FF
    assert version.uid & 0xFF == harness.vehicle.address.system
    assert harness.vehicle.body.frame.altitude == FIELD_ALTITUDE

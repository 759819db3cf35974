"""Flight parameters of ArduPilot, from the parameters of each vehicle type."""

from __future__ import annotations

from math import inf, isnan, nan, radians

import pytest

from mavstack.sim.ardupilot.flight_parameters import ArdupilotFlightParameters, flight_parameters_of
from mavstack.sim.autopilot.flight_parameters import FlightParameters
from mavstack.sim.vehicle_types import VehicleType
from tests.sim.harness import grounded

NAMES = sorted(FlightParameters.__annotations__.keys() - {"limits", "setpoint_frames"})


def flight_parameters(vehicle_type: str, **parameters: float) -> ArdupilotFlightParameters:
    vehicle = grounded(vehicle_type, "ardupilot").vehicle
    for name, value in parameters.items():
        vehicle.parameters.set(name, value)
    return flight_parameters_of(vehicle)


@pytest.mark.parametrize("vehicle_type", [each.value for each in VehicleType])
def test_every_flight_parameter_is_valid(vehicle_type):
    actual = flight_parameters(vehicle_type)
    for name in NAMES:
        assert not isnan(getattr(actual, name)), name
    assert actual.setpoint_frames
    assert actual.cruise_speed > 0.4


@pytest.mark.parametrize(
    ("vehicle_type", "parameter", "value", "name", "expected"),
    [
        ("copter", "PILOT_TKOFF_ALT", 700, "takeoff_altitude", 7.0),
        ("copter", "PILOT_TKOFF_ALT", 0, "takeoff_altitude", 10.0),
        ("copter", "WPNAV_SPEED", 800, "cruise_speed", 8.0),
        ("copter", "WPNAV_SPEED", 0, "cruise_speed", 0.1),
        ("copter", "WPNAV_SPEED", nan, "cruise_speed", 0.1),
        ("copter", "WPNAV_SPEED_UP", 150, "climb_speed", 1.5),
        ("copter", "WPNAV_SPEED_DN", 120, "sink_speed", 1.2),
        ("copter", "LAND_SPEED", 40, "land_speed", 0.4),
        ("copter", "LAND_ALT_LOW", 1500, "land_slow_altitude", 15.0),
        ("copter", "DISARM_DELAY", 0, "disarm_delay", inf),
        ("copter", "DISARM_DELAY", 5, "disarm_delay", 5.0),
        ("copter", "RTL_ALT", 2500, "return_altitude", 25.0),
        ("copter", "RTL_ALT_FINAL", 0, "return_descend_altitude", inf),
        ("copter", "RTL_ALT_FINAL", 400, "return_loiter_time", inf),
        ("copter", "RTL_LOIT_TIME", 3000, "return_loiter_time", 3.0),
        ("copter", "ANGLE_MAX", 2000, "lean_angle", radians(20)),
        ("copter", "CIRCLE_RATE", -20, "circle_radius", -10.0),
        ("copter", "GUID_OPTIONS", 8, "thrust_is_climb", False),
        ("plane", "TKOFF_ALT", 40, "takeoff_altitude", 40.0),
        ("plane", "RTL_ALTITUDE", -1, "return_altitude", -inf),
        ("plane", "LAND_DISARMDELAY", 0, "land_disarm_delay", inf),
        ("plane", "WP_LOITER_RAD", -70, "circle_radius", -70.0),
        ("plane", "ROLL_LIMIT_DEG", 35, "lean_angle", radians(35)),
        ("vtol", "Q_WP_SPEED", 400, "cruise_speed", 4.0),
        ("vtol", "Q_LAND_FINAL_SPD", 0.4, "land_speed", 0.4),
        ("rover", "WP_SPEED", 3, "cruise_speed", 3.0),
        ("rover", "CIRC_DIR", 1, "circle_radius", -20.0),
        ("rover", "WP_RADIUS", 0.1, "acceptance_radius", 0.5),
        ("sub", "SURFACE_DEPTH", -30, "return_altitude", -0.3),
    ],
)
def test_a_parameter_of_the_firmware(vehicle_type, parameter, value, name, expected):
    actual = flight_parameters(vehicle_type, **{parameter: value})
    assert getattr(actual, name) == pytest.approx(expected)


def test_limits_follow_their_parameters():
    vehicle = grounded("copter", "ardupilot").vehicle
    vehicle.parameters.set("WPNAV_ACCEL", 300)
    assert vehicle.body.limits.acceleration == pytest.approx(3.0)
    vehicle.parameters.set("ANGLE_MAX", 2000)
    assert vehicle.body.limits.tilt == pytest.approx(radians(20))
    for value in (0, nan):
        vehicle.parameters.set("WPNAV_ACCEL", value)
        assert vehicle.body.limits.acceleration == pytest.approx(3.0)

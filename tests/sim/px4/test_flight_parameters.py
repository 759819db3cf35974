"""PX4's flight parameters: every one is finite and flyable on every type, and follows its parameter."""

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
from tests.sim.px4.pilot import FIELD_ALTITUDE, Pilot

NAMES = sorted(FlightParameters.__abstractmethods__)


def flight_parameters(kind: VehicleType) -> Px4FlightParameters:
    vehicle = Pilot(kind.value, ready=False).vehicle
    return flight_parameters_of(vehicle)


@pytest.mark.parametrize("kind", list(VehicleType))
def test_every_figure_is_a_number_that_can_be_flown(kind: VehicleType) -> None:
    found = flight_parameters(kind)
    for name in NAMES:
        value = getattr(found, name)
        if name == "setpoint_frames":
            assert len(value) == 2
        elif name != "thrust_is_climb":
            assert isinstance(value, float | int), name
            assert not isnan(value), name
    assert found.cruise_speed > 0.4
    assert found.acceptance_radius > 0.2


@pytest.mark.parametrize(
    ("parameter", "value", "name", "figure"),
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
def test_a_multicopters_figure_follows_its_parameter(
    parameter: str, value: float, name: str, figure: float
) -> None:
    parameters = Parameters(Firmware.PX4, VehicleType.COPTER)
    found = MulticopterFlightParameters(parameters)
    parameters.set(parameter, value)
    assert getattr(found, name) == pytest.approx(figure)


@pytest.mark.parametrize(
    ("parameter", "value", "name", "figure"),
    [
        ("FW_AIRSPD_TRIM", 16.0, "cruise_speed", 16.0),
        ("FW_T_CLMB_R_SP", 2.5, "climb_speed", 2.5),
        ("FW_T_SINK_R_SP", 1.5, "sink_speed", 1.5),
        ("FW_LND_ANG", 8.0, "glide_slope", 0.1405),
        ("FW_MAN_R_MAX", 30.0, "lean_angle", radians(30)),
    ],
)
def test_a_wings_figure_follows_its_parameter(parameter: str, value: float, name: str, figure: float) -> None:
    parameters = Parameters(Firmware.PX4, VehicleType.PLANE)
    found = FixedWingFlightParameters(parameters)
    parameters.set(parameter, value)
    assert getattr(found, name) == pytest.approx(figure, rel=1e-3)


def test_a_vtol_is_a_multicopter_until_it_flies_on_its_wing() -> None:
    pilot = Pilot("vtol").in_the_air(40)
    assert pilot.autopilot.flight_parameters.cruise_speed == 5.0
    pilot.vehicle.body.transition_to(True)
    pilot.run(15.0)
    assert pilot.autopilot.flight_parameters.cruise_speed == 20.0


def test_the_bodys_limits_follow_their_parameters() -> None:
    pilot = Pilot()
    assert pilot.vehicle.body.limits.acceleration == 3.0
    pilot.vehicle.parameters.set("MPC_ACC_HOR", 2.0)
    pilot.vehicle.parameters.set("MPC_TILTMAX_AIR", 25.0)
    assert pilot.vehicle.body.limits.acceleration == 2.0
    assert pilot.vehicle.body.limits.tilt == pytest.approx(radians(25))


def test_identity_is_as_px4_tells_it() -> None:
    from mavstack.dialects import common

    pilot = Pilot()
    (version,) = pilot.request(common.AutopilotVersion)[:1]
    assert version.capabilities == CAPABILITIES == 59647
    assert version.flight_sw_version == 0x011000FF
    assert version.uid & 0xFF == pilot.vehicle.address.system
    assert pilot.vehicle.body.frame.altitude == FIELD_ALTITUDE

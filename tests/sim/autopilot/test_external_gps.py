"""GPS_INPUT and HIL_GPS as the GPS of simulated vehicles of both firmwares."""

from __future__ import annotations

from math import hypot, nan
from typing import TYPE_CHECKING, Any

import pytest

from mavstack.dialects import common
from mavstack.services import Address
from tests.sim.harness import SimulationHarness, VehicleHarness

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.dialects import Message

IGNORE = common.GpsInputIgnoreFlags
#: A receiver on the vehicle's own system, as PX4 demands.
ON_BOARD = Address(1, common.MavComponent.GPS)


def gps_input(one: VehicleHarness, north: float, east: float, **fields: Any) -> common.GpsInput:
    """Return GPS_INPUT with a position in metres from the origin."""
    latitude, longitude, altitude = one.vehicle.body.frame.to_global(north, east, 0.0)
    values = {
        "fix_type": 3, "lat": round(latitude * 1e7), "lon": round(longitude * 1e7), "alt": altitude,
        "hdop": 0.9, "vdop": 1.2, "vn": 1.0, "satellites_visible": 11,
    }  # fmt: skip
    return common.GpsInput(**(values | fields))


def hil_gps(one: VehicleHarness, north: float, east: float, **fields: Any) -> common.HilGps:
    """Return HIL_GPS with a position in metres from the origin."""
    latitude, longitude, altitude = one.vehicle.body.frame.to_global(north, east, 0.0)
    values = {
        "fix_type": 3, "lat": round(latitude * 1e7), "lon": round(longitude * 1e7),
        "alt": round(altitude * 1e3), "eph": 90, "epv": 120, "vn": 100, "satellites_visible": 11,
    }  # fmt: skip
    return common.HilGps(**(values | fields))


def ardupilot(gps_type: int = 14) -> VehicleHarness:
    one = SimulationHarness().add("copter", "ardupilot", GPS1_TYPE=gps_type)
    one.vehicle.reboot()
    one.source = ON_BOARD
    return one


def px4(use: int = 1) -> VehicleHarness:
    one = SimulationHarness().add("copter", "px4", MAV_USEHILGPS=use)
    one.source = ON_BOARD
    return one


def feed(one: VehicleHarness, make: Callable[[], Message], seconds: float = 6.0) -> common.GpsRawInt:
    """Send a report ten times a second; return the last GPS_RAW_INT."""
    one.received.clear()
    one.receiving = True
    one.run(seconds, lambda: one.send(make()))
    return one.received_of(common.GpsRawInt)[-1]


def is_near(one: VehicleHarness, north: float, east: float) -> bool:
    here = one.vehicle.body.estimate
    return hypot(here.north - north, here.east - east) < 3.0


@pytest.mark.parametrize("report", [gps_input, hil_gps])
def test_ardupilot_with_gps_by_mavlink_follows_the_reports(report) -> None:
    one = ardupilot()
    raw = feed(one, lambda: report(one, 500.0, -300.0))
    assert is_near(one, 500.0, -300.0)
    assert one.autopilot.has_position
    sent = report(one, 500.0, -300.0)
    assert (raw.lat, raw.lon, raw.fix_type, raw.satellites_visible) == (sent.lat, sent.lon, 3, 11)
    assert (raw.eph, raw.epv, raw.vel) == (90, 120, 100)
    home = one.vehicle.body.frame.to_local(one.autopilot.home.latitude, one.autopilot.home.longitude, 0.0)
    assert hypot(home[0] - 500.0, home[1] + 300.0) < 3.0


def test_ardupilot_has_no_fix_before_the_first_report_and_after_four_seconds_of_silence() -> None:
    one = ardupilot()
    one.run(8)
    assert one.vehicle.body.sensors.gps_fix == 1
    assert not one.autopilot.has_position
    feed(one, lambda: gps_input(one, 0.0, 0.0))
    one.run(3.8)
    assert one.autopilot.has_position
    assert one.vehicle.body.sensors.gps_fix == 3
    one.run(0.5)
    assert one.vehicle.body.sensors.gps_fix == 1
    one.run(6)
    assert not one.autopilot.has_position
    feed(one, lambda: gps_input(one, 0.0, 0.0))
    assert one.autopilot.has_position


def test_a_report_without_a_fix_gives_no_position() -> None:
    one = ardupilot()
    raw = feed(one, lambda: gps_input(one, 500.0, 0.0, fix_type=2), 8.0)
    assert raw.fix_type == 2
    assert not one.autopilot.has_position
    assert not is_near(one, 500.0, 0.0)


def test_ignored_fields_keep_their_last_values() -> None:
    one = ardupilot()
    feed(one, lambda: gps_input(one, 0.0, 0.0))
    ignored = IGNORE.ALT | IGNORE.HDOP | IGNORE.VDOP | IGNORE.VEL_HORIZ | IGNORE.VEL_VERT
    zeros = {"alt": 77.0, "hdop": 5.0, "vdop": 6.0, "vn": 9.0, "vd": 4.0}
    raw = feed(one, lambda: gps_input(one, 0.0, 0.0, ignore_flags=ignored, **zeros), 1.0)
    assert (raw.alt, raw.eph, raw.epv, raw.vel) == (0, 90, 120, 100)
    assert one.vehicle.body.sensors.gps_velocity_down == 0.0


def test_values_that_are_no_numbers_do_no_harm() -> None:
    one = ardupilot()
    wrong = {"lat": 2**31 - 1, "lon": -(2**31), "alt": nan, "hdop": nan, "vdop": -1e30, "vn": nan, "vd": 1e30}
    raw = feed(one, lambda: gps_input(one, 0.0, 0.0, fix_type=255, satellites_visible=255, **wrong), 4.0)
    assert raw.fix_type == 255
    assert all(value == value for value in one.vehicle.body.estimate)


def test_ardupilot_with_another_receiver_ignores_the_reports() -> None:
    one = ardupilot(gps_type=1)
    feed(one, lambda: gps_input(one, 500.0, 0.0))
    feed(one, lambda: hil_gps(one, 500.0, 0.0))
    assert is_near(one, 0.0, 0.0)
    assert one.autopilot.has_position


def test_the_type_of_the_receiver_counts_at_boot() -> None:
    one = ardupilot(gps_type=1)
    one.set(GPS1_TYPE=14)
    feed(one, lambda: gps_input(one, 500.0, 0.0))
    assert is_near(one, 0.0, 0.0)
    one.vehicle.reboot()
    feed(one, lambda: gps_input(one, 500.0, 0.0))
    assert is_near(one, 500.0, 0.0)
    one.set(GPS1_TYPE=1)
    one.vehicle.reboot()
    one.run(15)
    assert is_near(one, 0.0, 0.0)


def test_px4_takes_hil_gps_of_its_own_system_while_mav_usehilgps_is_set() -> None:
    one = px4()
    raw = feed(one, lambda: hil_gps(one, 500.0, -300.0))
    assert is_near(one, 500.0, -300.0)
    assert (raw.lat, raw.fix_type, raw.satellites_visible) == (hil_gps(one, 500.0, 0.0).lat, 3, 11)
    one.run(2.5)
    assert one.vehicle.body.sensors.gps_satellites != 11
    one.run(12)
    assert is_near(one, 0.0, 0.0)


@pytest.mark.parametrize("reason", ["parameter", "system", "message"])
def test_px4_ignores_other_reports(reason) -> None:
    one = px4(use=int(reason != "parameter"))
    if reason == "system":
        one.source = Address(255, 190)
    report = gps_input if reason == "message" else hil_gps
    feed(one, lambda: report(one, 500.0, 0.0))
    assert is_near(one, 0.0, 0.0)


def test_faults_of_the_own_receiver_wait_while_another_is_used() -> None:
    one = ardupilot()
    one.inject("gps spoof 100 0", "gps off")
    feed(one, lambda: gps_input(one, 500.0, 0.0))
    assert is_near(one, 500.0, 0.0)
    assert one.autopilot.has_position
    one.set(GPS1_TYPE=1)
    one.vehicle.reboot()
    one.run(2)
    assert one.vehicle.body.sensors.gps_fix == 1

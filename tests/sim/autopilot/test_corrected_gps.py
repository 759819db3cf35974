from __future__ import annotations

from math import hypot

import pytest

from mavstack.dialects import common
from mavstack.services.rtk import fragment
from tests.gnss.test_rtcm import msm, station
from tests.sim.harness import airborne


def send(vehicle, frame) -> None:
    for message in fragment(frame.data, 0):
        vehicle.send(message)


def fix_of(vehicle) -> int:
    return vehicle.vehicle.body.sensors.gps_fix


@pytest.mark.parametrize("firmware", ["ardupilot", "px4"])
def test_the_fix_follows_the_corrections(firmware):
    copter = airborne("copter", firmware)
    for second in range(3):
        send(copter, msm(1074, second, 250))
        copter.run(1)
    assert fix_of(copter) == 3  # without the position of the station
    send(copter, station())
    copter.run(1)
    send(copter, msm(1074, 4, 250))
    copter.run(0.1)
    assert fix_of(copter) == 5
    for second in range(14):
        send(copter, msm(1074, 10 + second, 250))
        copter.run(1)
    assert fix_of(copter) == 6
    copter.run(10)
    estimate, truth = copter.vehicle.body.estimate, copter.vehicle.body.truth
    assert fix_of(copter) == 5
    assert hypot(estimate.north - truth.north, estimate.east - truth.east) < 0.5
    copter.run(25)
    assert fix_of(copter) == 3


def test_rtk_is_in_the_telemetry_and_precise():
    copter = airborne("copter", "ardupilot")
    send(copter, station())
    errors = []
    for second in range(40):
        send(copter, msm(1074, second, 250))
        copter.run(1)
        estimate, truth = copter.vehicle.body.estimate, copter.vehicle.body.truth
        errors.append(hypot(estimate.north - truth.north, estimate.east - truth.east))
    assert max(errors[-10:]) < 0.05
    copter.receiving = True
    copter.run(2)
    raw = [message for message in copter.received if isinstance(message, common.GpsRawInt)]
    assert raw[-1].fix_type == common.GpsFixType.RTK_FIXED
    assert raw[-1].h_acc == 14
    copter.vehicle.reboot()
    assert fix_of(copter) != 6

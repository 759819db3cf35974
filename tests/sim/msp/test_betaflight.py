from __future__ import annotations

import dataclasses
from math import degrees

import pytest

from mavstack.msp.messages.gps import CompGps, GpsRescue, RawGps, SetGpsRescue
from mavstack.msp.messages.motors import Motor, SetMotor
from mavstack.msp.messages.rc import FailsafeConfig, FailsafeProcedure, Rc, SetFailsafeConfig
from mavstack.msp.messages.sensors import Altitude, Attitude
from mavstack.msp.messages.status import StatusEx
from tests.sim.msp.peer import HIGH, LOW, MIDDLE, Peer


def names(peer: Peer) -> set[str]:
    """Return the names of the boxes that MSP_STATUS_EX reports."""
    boxes = peer.controller.system.boxes.boxes
    return {boxes[position].name for position in peer.get(StatusEx).active_modes}


def test_the_reasons_not_to_arm_go_away_one_after_the_other():
    peer = Peer()
    reasons = peer.get(StatusEx).arming_disable_reasons
    assert set(reasons) == {"RX_FAILSAFE", "BOOT_GRACE_TIME", "CALIBRATING"}
    peer.transmit(5.5, throttle=1200)
    assert peer.get(StatusEx).arming_disable_reasons == ("THROTTLE",)
    peer.aux[0] = HIGH
    peer.transmit(0.1, throttle=1200)
    assert peer.get(StatusEx).arming_disable_reasons == ("THROTTLE", "ARM_SWITCH")
    peer.transmit(0.1)
    assert peer.get(StatusEx).arming_disable_reasons == ("ARM_SWITCH",)
    peer.aux[0] = LOW
    peer.transmit(0.1)
    peer.aux[0] = HIGH
    peer.transmit(0.1)
    assert peer.get(StatusEx).arming_disable_reasons == ()
    assert "ARM" in names(peer)
    assert peer.texts("armed") == ["armed by switch"]


def test_a_signal_that_returns_with_the_switch_on_does_not_arm():
    peer = Peer()
    peer.run(5.5)
    peer.aux[0] = HIGH
    peer.transmit(0.2)
    assert "NOT_DISARMED" in peer.controller.arming_disable_reasons


def test_calibrations_take_their_time():
    peer = Peer()
    peer.transmit(5.5)
    assert peer.request(205) is not None
    assert peer.request(206) is not None
    peer.run(0.5)
    assert peer.texts("text") == ["accelerometer calibration started", "compass calibration started"]
    assert "CALIBRATING" in peer.controller.arming_disable_reasons
    peer.run(1.0)
    assert peer.texts("text")[-1] == "accelerometer calibration complete"


def test_motors_turn_only_in_a_test_while_disarmed():
    peer = Peer()
    assert peer.get(Motor).motors == (1000,) * 4 + (0,) * 4
    assert peer.write(SetMotor((1100, 1200, 1300, 1400, 0, 0, 0, 0)))
    assert peer.get(Motor).motors[:4] == (1100, 1200, 1300, 1400)
    peer.arm()
    assert set(peer.get(Motor).motors[:4]) < set(range(1000, 1200))


def test_channels_are_reported_as_roll_pitch_yaw_throttle():
    peer = Peer()
    peer.transmit(0.1, roll=1100, pitch=1200, yaw=1300, throttle=1400)
    assert peer.get(Rc).channels[:4] == (1100, 1200, 1300, 1400)


def test_the_beeper_is_an_event():
    peer = Peer()
    peer.aux[3] = HIGH
    peer.transmit(0.1)
    assert peer.texts("beeper") == ["beeper on"]
    assert "BEEPER" in names(peer)


@pytest.mark.flight
def test_the_sticks_fly_it_in_angle_mode():
    peer = Peer()
    peer.arm()
    peer.aux[1] = HIGH
    peer.transmit(2.0, throttle=1650)
    assert peer.get(Altitude).altitude > 2
    peer.transmit(1.5, throttle=1580, roll=1750, pitch=1600)
    attitude = peer.get(Attitude)
    assert attitude.roll == pytest.approx(30, abs=2)
    assert attitude.pitch == pytest.approx(12, abs=2)  # nose down is positive
    assert names(peer) >= {"ARM", "ANGLE"}
    assert peer.get(CompGps).distance_to_home > 2
    assert peer.get(RawGps).ground_speed > 1


@pytest.mark.flight
def test_acro_mode_turns_at_rates():
    peer = Peer()
    peer.arm()
    peer.transmit(2.0, throttle=1650)
    heading = degrees(peer.controller.body.truth.yaw)
    peer.transmit(1.0, throttle=1600, yaw=1600)
    assert peer.controller.mode == "ACRO"
    assert degrees(peer.controller.body.truth.yaw) - heading == pytest.approx(38, abs=8)
    peer.transmit(1.0, throttle=1600, roll=1600)
    assert degrees(peer.controller.body.truth.roll) > 10


@pytest.mark.flight
@pytest.mark.parametrize("procedure", list(FailsafeProcedure))
def test_a_lost_signal_starts_the_failsafe(procedure):
    peer = Peer()
    settings = dataclasses.replace(peer.get(FailsafeConfig), procedure=procedure)
    assert peer.write(SetFailsafeConfig.from_message(settings))
    peer.arm()
    peer.aux[1] = HIGH
    peer.transmit(3.0, throttle=1650)
    peer.run(3.0)
    assert peer.controller.armed is (procedure is not FailsafeProcedure.DROP_IT)
    if peer.controller.armed:
        assert "FAILSAFE" in names(peer)
        while peer.controller.armed:
            peer.run(1.0)
            assert peer.simulation.elapsed < 80
        assert peer.controller.body.on_ground
    assert "RX_FAILSAFE" in peer.controller.arming_disable_reasons


@pytest.mark.flight
def test_gps_rescue_flies_home_and_lands():
    peer = Peer()
    assert peer.write(SetGpsRescue.from_message(peer.get(GpsRescue), return_altitude=12))
    peer.arm()
    peer.aux[1] = HIGH
    peer.transmit(2.0, throttle=1600)
    peer.transmit(4.0, throttle=1540, pitch=1800)
    assert peer.get(CompGps).distance_to_home > 20
    peer.aux[2] = HIGH
    peer.transmit(1.0, throttle=MIDDLE)
    assert "GPS RESCUE" in names(peer)
    while peer.controller.armed:
        peer.transmit(1.0, throttle=MIDDLE)
        assert peer.simulation.elapsed < 120
    assert peer.get(CompGps).distance_to_home < 6

from __future__ import annotations

from mavstack.msp.messages.battery import InavAnalog
from mavstack.msp.messages.navigation import Safehome, SetSafehome
from mavstack.msp.messages.pid import InavPid, Pid, SetPid
from mavstack.msp.messages.rc import InavRateProfile, RcTuning, SetRcTuning
from mavstack.msp.messages.status import InavStatus, SensorStatus, StatusEx
from tests.sim.msp.peer import HIGH, LOW, Peer


def test_reasons_not_to_arm():
    peer = Peer("inav")
    assert set(peer.get(InavStatus).arming_disable_reasons) == {"SENSORS_CALIBRATING", "RC_LINK"}
    peer.aux[3] = HIGH
    peer.transmit(1.5, throttle=1300)
    assert set(peer.get(InavStatus).arming_disable_reasons) == {"NAVIGATION_UNSAFE", "THROTTLE"}
    peer.aux[3] = LOW
    peer.transmit(0.1)
    assert peer.get(InavStatus).arming_disable_reasons == ()
    assert peer.get(StatusEx).arming_disable_reasons == ()
    peer.aux[0] = HIGH
    peer.transmit(0.1)
    status = peer.get(InavStatus)
    assert status.is_armed
    assert 0 in status.active_modes


def test_navigation_needs_a_position():
    peer = Peer("inav")
    peer.controller.body.fail_gps()
    peer.transmit(6.0)
    assert peer.get(InavStatus).arming_disable_reasons == ("NAVIGATION_UNSAFE",)


def test_battery_and_sensors():
    peer = Peer("inav")
    peer.run(0.1)
    analog = peer.get(InavAnalog)
    assert (analog.cell_count, analog.remaining) == (4, 100)
    assert peer.get(SensorStatus).is_healthy


def test_gains_and_rates_have_two_layouts():
    peer = Peer("inav")
    gains = peer.get(Pid).controllers
    changed = tuple(type(each)(each.p + 1, each.i, each.d) for each in gains)
    assert peer.write(SetPid(changed))
    assert [each.p for each in peer.get(InavPid).controllers] == [each.p for each in changed]
    assert peer.write(SetRcTuning.from_message(peer.get(RcTuning), yaw_rate=33))
    assert peer.get(InavRateProfile).yaw_rate == 33


def test_safe_homes():
    peer = Peer("inav")
    written = SetSafehome(2, True, 47.5, 8.25)
    assert peer.write(written)
    assert peer.get(Safehome, b"\2") == Safehome(2, True, 47.5, 8.25)
    assert not peer.write(SetSafehome(8, True, 47.5, 8.25))

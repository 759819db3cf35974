from __future__ import annotations

from mavstack.gnss.rtcm import RtcmFrame
from mavstack.services import Address
from mavstack.services.rtk import CorrectionReceiver, fragment
from mavstack.services.rtk.receiver import MAX_SENDERS
from tests.gnss.test_rtcm import msm
from tests.services.network import GROUND, START, VEHICLE
from tests.services.single_service import deliver


def test_senders_are_joined_apart_and_bounded():
    receiver = CorrectionReceiver(VEHICLE)
    first, second = fragment(msm(1074, 1, 300).data, 1), fragment(msm(1084, 1, 300).data, 1)
    other = Address(254, 190)
    for one, two in zip(first, second, strict=True):
        deliver(receiver, one, GROUND, START)
        deliver(receiver, two, other, START)
    assert [event.frame.number for event in receiver.events()] == [1074, 1084]
    for system in range(1, 60):
        deliver(receiver, first[0], Address(system, 1), START)
    assert len(receiver._senders) == MAX_SENDERS
    assert receiver.received == 2


def test_a_lost_fragment_and_a_wrong_checksum():
    receiver = CorrectionReceiver(VEHICLE)
    deliver(receiver, fragment(msm(1074, 1, 400).data, 1)[0], GROUND, START)
    deliver(receiver, fragment(msm(1074, 2, 100).data, 2)[0], GROUND, START)
    assert receiver.lost == 1
    broken = RtcmFrame.of(b"\x43\x20abc").data[:-1] + b"\x00"
    deliver(receiver, fragment(broken, 3)[0], GROUND, START)
    assert receiver.received == 1

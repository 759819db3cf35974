"""Who uses an address: two of them are told once, with what is known of each."""

from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.services import Address
from mavstack.services.heartbeat import (
    AddressClash,
    AddressClashOver,
    OwnAddressConflict,
    ComponentChanged,
    ComponentFound,
    ComponentLost,
    ComponentRebooted,
    ComponentReturned,
    Discovery,
    describe_kind,
)
from mavstack.services.version import AutopilotVersion
from tests.services.heartbeat.test_discovery import packet
from tests.services.network import GROUND, START, VEHICLE

TYPE, AUTOPILOT = common.MavType, common.MavAutopilot
COPTER = common.Heartbeat(type=TYPE.QUADROTOR, autopilot=AUTOPILOT.ARDUPILOTMEGA)
PLANE = common.Heartbeat(type=TYPE.FIXED_WING, autopilot=AUTOPILOT.PX4)
GIMBAL = common.Heartbeat(type=TYPE.GIMBAL, autopilot=AUTOPILOT.INVALID)
STATION = common.Heartbeat(type=TYPE.GCS, autopilot=AUTOPILOT.INVALID)


class Watcher:
    """A discovery, and where its packets come from."""

    def __init__(self) -> None:
        self.channel = ""
        self.echoes = False
        self.discovery = Discovery(GROUND, is_echo=lambda packet: self.echoes, where=lambda: self.channel)

    def hear(self, message, at, channel="one", source=VEHICLE):
        self.channel = channel
        self.discovery.receive(packet(message, source), START + at)

    def told(self, *kinds):
        events = self.discovery.events()
        return [event for event in events if isinstance(event, kinds or object)]


def test_kinds_that_go_to_and_fro_are_a_clash_told_once():
    watcher = Watcher()
    for second in range(60):
        watcher.hear(COPTER, second, "one")
        watcher.hear(PLANE, second + 0.5, "two")
    (clash,) = watcher.told(AddressClash)
    assert [claim.kind for claim in clash.claims] == [
        (TYPE.QUADROTOR, AUTOPILOT.ARDUPILOTMEGA),
        (TYPE.FIXED_WING, AUTOPILOT.PX4),
    ]
    assert [claim.channels for claim in clash.claims] == [("one",), ("two",)]
    assert "; ".join(map(str, clash.claims)) == "quadrotor with ArduPilot on one; fixed wing with PX4 on two"
    assert watcher.discovery.clash_of(VEHICLE)


def test_a_clash_of_kinds_is_over_when_one_is_gone():
    watcher = Watcher()
    for second in range(10):
        watcher.hear(COPTER, second)
        watcher.hear(PLANE, second + 0.5)
    for second in range(10, 60):
        watcher.hear(PLANE, second)
    kinds = [type(event) for event in watcher.told(AddressClash, AddressClashOver)]
    assert kinds == [AddressClash, AddressClashOver]
    assert not watcher.discovery.clash_of(VEHICLE)


def test_a_kind_that_changes_once_was_set_up_anew():
    watcher = Watcher()
    for second in range(10):
        watcher.hear(COPTER, second)
    for second in range(13, 30):
        watcher.hear(PLANE, second)
    assert not watcher.told(AddressClash)


def test_one_odd_heartbeat_is_no_clash():
    watcher = Watcher()
    for second in range(20):
        watcher.hear(PLANE if second == 9 else COPTER, second)
    assert not watcher.told(AddressClash)


def test_a_reboot_amid_a_clash_of_kinds_is_not_told():
    watcher = Watcher()
    for second in range(60):
        watcher.hear(COPTER, second)
        watcher.hear(PLANE, second + 0.5)
        if second not in (30, 31):
            since_boot = second + 100 if second < 30 else second - 31
            watcher.hear(common.SystemTime(time_boot_ms=since_boot * 1000), second)
    assert [type(event) for event in watcher.told(AddressClash, ComponentRebooted)] == [AddressClash]


def test_a_change_of_kind_is_told():
    watcher = Watcher()
    watcher.hear(common.Heartbeat(type=TYPE.GENERIC, autopilot=AUTOPILOT.INVALID), 0)
    watcher.hear(COPTER, 1)
    watcher.hear(COPTER, 2)
    (changed,) = watcher.told(ComponentChanged)
    assert (changed.before.is_autopilot, changed.component.is_autopilot) == (False, True)


def test_two_lives_are_a_clash_and_no_reboots():
    watcher = Watcher()
    watcher.hear(COPTER, 0)
    for tick in range(200):
        at = tick * 0.25
        watcher.hear(common.Attitude(time_boot_ms=100_000 + round(at * 1000)), at, "one")
        watcher.hear(common.Attitude(time_boot_ms=5_000 + round(at * 1000)), at, "two")
    (clash,) = watcher.told(AddressClash, ComponentRebooted)
    assert isinstance(clash, AddressClash)
    booted = [round(claim.booted_at - START) for claim in clash.claims]
    assert booted == [-100, -5]
    assert [claim.channels for claim in clash.claims] == [("one",), ("two",)]


@pytest.mark.parametrize(("apart", "clashes"), [(0.2, 1), (60.0, 0)])
def test_two_unique_ids_within_seconds_are_a_clash(apart, clashes):
    watcher = Watcher()
    watcher.hear(COPTER, 0)
    watcher.hear(AutopilotVersion(uid=1).to_message(), 1.0)
    watcher.hear(AutopilotVersion(uid=0).to_message(), 1.1)  # who tells none contradicts nobody
    watcher.hear(AutopilotVersion(uid=1).to_message(), 1.2)
    watcher.hear(AutopilotVersion(uid=2).to_message(), 1.2 + apart)
    told = watcher.told(AddressClash)
    assert len(told) == clashes
    for clash in told:
        assert [claim.unique_id for claim in clash.claims] == [f"{1:016x}", f"{2:016x}"]


def test_a_payload_with_the_autopilots_address_does_not_make_it_go_away():
    watcher = Watcher()
    for second in range(20):
        watcher.hear(COPTER, second)
        watcher.hear(GIMBAL, second + 0.5)
        assert watcher.discovery.components[VEHICLE].is_autopilot
    assert len(watcher.told(AddressClash)) == 1
    for second in range(20, 30):
        watcher.hear(GIMBAL, second)
    assert not watcher.discovery.components[VEHICLE].is_autopilot


def test_someone_with_our_address_is_told_once():
    watcher = Watcher()
    for second in range(10):
        watcher.hear(STATION, second, source=GROUND)
    (taken,) = watcher.told()
    assert isinstance(taken, OwnAddressConflict)
    assert taken.component.kind == "ground station"
    assert not watcher.discovery.components
    watcher.hear(STATION, 100, source=GROUND)
    assert len(watcher.told(OwnAddressConflict)) == 1


def test_our_own_echo_is_nobody():
    watcher = Watcher()
    watcher.echoes = True
    watcher.hear(STATION, 0, source=GROUND)
    watcher.hear(common.Attitude(time_boot_ms=5), 0, source=GROUND)
    assert not watcher.told()


def test_who_cannot_be_reached_any_more_is_lost_at_once():
    watcher = Watcher()
    watcher.hear(COPTER, 0)
    watcher.hear(GIMBAL, 0, source=Address(1, 154))
    watcher.discovery.unreachable([VEHICLE, Address(9, 9)], "its link is closed")
    lost = watcher.told(ComponentLost)
    assert [(event.component.address, event.reason) for event in lost] == [(VEHICLE, "its link is closed")]
    watcher.discovery.unreachable([VEHICLE], "its link is closed")
    watcher.hear(COPTER, 7.5)
    (back,) = watcher.told()
    assert isinstance(back, ComponentReturned)
    assert back.after == 7.5
    assert not watcher.told(ComponentFound)


@pytest.mark.parametrize(
    ("kind", "words"),
    [
        ((TYPE.CAMERA, AUTOPILOT.INVALID), "camera"),
        ((TYPE.GCS, AUTOPILOT.INVALID), "ground station"),
        ((TYPE.VTOL_TILTROTOR, AUTOPILOT.PX4), "VTOL tiltrotor with PX4"),
        ((250, AUTOPILOT.INVALID), "type 250"),
        ((TYPE.QUADROTOR, 251), "quadrotor with autopilot 251"),
        ((TYPE.QUADROTOR, AUTOPILOT.PPZ), "quadrotor with PPZ"),
    ],
)
def test_kinds_in_words(kind, words):
    assert describe_kind(*kind) == words

"""Address conflicts: several senders of one address are reported once, with what is known of each."""

from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.services import Address
from mavstack.services.heartbeat import (
    AddressConflict,
    AddressConflictEnded,
    ComponentChanged,
    ComponentFound,
    ComponentLost,
    ComponentRebooted,
    ComponentReturned,
    Discovery,
    OwnAddressConflict,
    describe_component,
)
from mavstack.services.version import AutopilotVersion
from tests.services.heartbeat.test_discovery import packet
from tests.services.network import GROUND, START, VEHICLE

TYPE, AUTOPILOT = common.MavType, common.MavAutopilot
COPTER = common.Heartbeat(type=TYPE.QUADROTOR, autopilot=AUTOPILOT.ARDUPILOTMEGA)
PLANE = common.Heartbeat(type=TYPE.FIXED_WING, autopilot=AUTOPILOT.PX4)
GIMBAL = common.Heartbeat(type=TYPE.GIMBAL, autopilot=AUTOPILOT.INVALID)
STATION = common.Heartbeat(type=TYPE.GCS, autopilot=AUTOPILOT.INVALID)


class ConflictHarness:
    """A discovery and the channel of its packets."""

    def __init__(self) -> None:
        self.channel = ""
        self.echoes = False
        self.discovery = Discovery(
            GROUND, is_echo=lambda packet: self.echoes, channel_name=lambda: self.channel
        )

    def receive(self, message, at, channel="one", source=VEHICLE):
        self.channel = channel
        self.discovery.receive(packet(message, source), START + at)

    def events(self, *kinds):
        events = self.discovery.events()
        return [event for event in events if isinstance(event, kinds or object)]


def test_alternating_types_are_a_conflict_reported_once():
    watcher = ConflictHarness()
    for second in range(60):
        watcher.receive(COPTER, second, "one")
        watcher.receive(PLANE, second + 0.5, "two")
    (conflict,) = watcher.events(AddressConflict)
    assert [sender.type_and_autopilot for sender in conflict.senders] == [
        (TYPE.QUADROTOR, AUTOPILOT.ARDUPILOTMEGA),
        (TYPE.FIXED_WING, AUTOPILOT.PX4),
    ]
    assert [sender.channels for sender in conflict.senders] == [("one",), ("two",)]
    assert (
        "; ".join(map(str, conflict.senders)) == "quadrotor with ArduPilot on one; fixed wing with PX4 on two"
    )
    assert watcher.discovery.has_conflict(VEHICLE)


def test_conflict_of_types_ends_when_one_sender_is_gone():
    watcher = ConflictHarness()
    for second in range(10):
        watcher.receive(COPTER, second)
        watcher.receive(PLANE, second + 0.5)
    for second in range(10, 60):
        watcher.receive(PLANE, second)
    kinds = [type(event) for event in watcher.events(AddressConflict, AddressConflictEnded)]
    assert kinds == [AddressConflict, AddressConflictEnded]
    assert not watcher.discovery.has_conflict(VEHICLE)


def test_single_change_of_type_is_no_conflict():
    watcher = ConflictHarness()
    for second in range(10):
        watcher.receive(COPTER, second)
    for second in range(13, 30):
        watcher.receive(PLANE, second)
    assert not watcher.events(AddressConflict)


def test_single_odd_heartbeat_is_no_conflict():
    watcher = ConflictHarness()
    for second in range(20):
        watcher.receive(PLANE if second == 9 else COPTER, second)
    assert not watcher.events(AddressConflict)


def test_reboot_during_a_conflict_is_not_reported():
    watcher = ConflictHarness()
    for second in range(60):
        watcher.receive(COPTER, second)
        watcher.receive(PLANE, second + 0.5)
        if second not in (30, 31):
            since_boot = second + 100 if second < 30 else second - 31
            watcher.receive(common.SystemTime(time_boot_ms=since_boot * 1000), second)
    assert [type(event) for event in watcher.events(AddressConflict, ComponentRebooted)] == [AddressConflict]


def test_change_of_type_is_reported():
    watcher = ConflictHarness()
    watcher.receive(common.Heartbeat(type=TYPE.GENERIC, autopilot=AUTOPILOT.INVALID), 0)
    watcher.receive(COPTER, 1)
    watcher.receive(COPTER, 2)
    (changed,) = watcher.events(ComponentChanged)
    assert (changed.before.is_autopilot, changed.component.is_autopilot) == (False, True)


def test_two_boots_are_a_conflict_and_no_reboots():
    watcher = ConflictHarness()
    watcher.receive(COPTER, 0)
    for tick in range(200):
        at = tick * 0.25
        watcher.receive(common.Attitude(time_boot_ms=100_000 + round(at * 1000)), at, "one")
        watcher.receive(common.Attitude(time_boot_ms=5_000 + round(at * 1000)), at, "two")
    (conflict,) = watcher.events(AddressConflict, ComponentRebooted)
    assert isinstance(conflict, AddressConflict)
    booted = [round(sender.booted_at - START) for sender in conflict.senders]
    assert booted == [-100, -5]
    assert [sender.channels for sender in conflict.senders] == [("one",), ("two",)]


def versions(*uids, apart=0.2):
    """A harness that received a copter's AUTOPILOT_VERSIONs with these ids, on one channel."""
    watcher = ConflictHarness()
    watcher.receive(COPTER, 0)
    for number, uid in enumerate(uids):
        watcher.receive(AutopilotVersion(uid=uid).to_message(), 1 + number * apart)
    return watcher


def test_two_unique_ids_in_turn_are_a_conflict():
    (conflict,) = versions(1, 0, 1, 2, 1).events(AddressConflict)  # an empty id contradicts none
    assert [sender.unique_id for sender in conflict.senders] == [f"{1:016x}", f"{2:016x}"]
    assert conflict.differs == ("unique id",)


def test_a_board_that_is_replaced_is_no_conflict():
    assert not versions(1, 1, 2, 2).events(AddressConflict)
    assert not versions(1, 2, 1, apart=60.0).events(AddressConflict)


def test_the_short_id_of_mavlink_1_does_not_contradict_the_long_one():
    watcher = ConflictHarness()
    watcher.receive(COPTER, 0)
    for second in range(5):
        watcher.receive(AutopilotVersion(uid=1, uid2=b"long").to_message(), second, "two")
        watcher.receive(AutopilotVersion(uid=1).to_message(), second + 0.5, "one")
    assert not watcher.events(AddressConflict)


def test_payload_with_the_autopilots_address_does_not_replace_it():
    watcher = ConflictHarness()
    for second in range(20):
        watcher.receive(COPTER, second)
        watcher.receive(GIMBAL, second + 0.5)
        assert watcher.discovery.components[VEHICLE].is_autopilot
    assert len(watcher.events(AddressConflict)) == 1
    for second in range(20, 30):
        watcher.receive(GIMBAL, second)
    assert not watcher.discovery.components[VEHICLE].is_autopilot


def test_own_address_conflict_is_reported_once():
    watcher = ConflictHarness()
    for second in range(10):
        watcher.receive(STATION, second, source=GROUND)
    (conflict,) = watcher.events()
    assert isinstance(conflict, OwnAddressConflict)
    assert conflict.component.description == "ground station"
    assert not watcher.discovery.components
    watcher.receive(STATION, 100, source=GROUND)
    assert len(watcher.events(OwnAddressConflict)) == 1


def test_echo_of_own_heartbeat_is_ignored():
    watcher = ConflictHarness()
    watcher.echoes = True
    watcher.receive(STATION, 0, source=GROUND)
    watcher.receive(common.Attitude(time_boot_ms=5), 0, source=GROUND)
    assert not watcher.events()


def test_unreachable_component_is_lost_at_once():
    watcher = ConflictHarness()
    watcher.receive(COPTER, 0)
    watcher.receive(GIMBAL, 0, source=Address(1, 154))
    watcher.discovery.unreachable([VEHICLE, Address(9, 9)], "its link is closed")
    lost = watcher.events(ComponentLost)
    assert [(event.component.address, event.reason) for event in lost] == [(VEHICLE, "its link is closed")]
    watcher.discovery.unreachable([VEHICLE], "its link is closed")
    watcher.receive(COPTER, 7.5)
    (back,) = watcher.events()
    assert isinstance(back, ComponentReturned)
    assert back.after == 7.5
    assert not watcher.events(ComponentFound)


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
def test_component_descriptions(kind, words):
    assert describe_component(*kind) == words

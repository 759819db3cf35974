"""The events of a simulated PX4: beside its status texts, with metadata, repeated on request."""

from __future__ import annotations

import lzma

import pytest

from mavstack.dialects import common
from mavstack.services.component_metadata import parse_general
from mavstack.services.events import decode_content, parse_event_metadata
from mavstack.sim.event_metadata import EVENTS, fnv1a
from mavstack.sim.parameters import served_metadata
from mavstack.sim.vehicle_types import Firmware, VehicleType
from tests.sim.harness import CMD, GROUND, RESULT
from tests.sim.px4.harness import Px4Harness

TABLE = parse_event_metadata(
    served_metadata(Firmware.PX4, VehicleType.COPTER).files["etc/extras/all_events.json.xz"]
)


def decoded(harness: Px4Harness) -> list[tuple[str, str]]:
    events = (
        decode_content(TABLE[event.id], bytes(event.arguments)) for event in harness.received_of(common.Event)
    )
    return [(event.name.removeprefix("px4::"), event.message) for event in events]


def request(harness: Px4Harness, first: int, last: int) -> None:
    message = common.RequestEvent(
        target_system=1, target_component=1, first_sequence=first, last_sequence=last
    )
    harness.send(message)
    harness.run(0.2)


def test_the_general_file_names_the_events():
    served = served_metadata(Firmware.PX4, VehicleType.COPTER)
    general = lzma.decompress(served.files["etc/extras/component_general.json.xz"])
    found = parse_general(general)[common.CompMetadataType.EVENTS]
    assert found.uri == "mftp://etc/extras/all_events.json.xz"
    assert len(TABLE) == len(EVENTS)


def test_ids_are_those_of_px4():
    assert fnv1a("foobar") == 0xBF9CF968, "a published test vector"
    assert TABLE[0x01000000 | fnv1a("commander_armed_by") & 0xFFFFFF].name == "px4::commander_armed_by"


def test_arming_and_disarming_are_events():
    harness = Px4Harness()
    harness.arm()
    harness.command(CMD.COMPONENT_ARM_DISARM, 0)
    assert decoded(harness) == [
        ("commander_armed_by", "Armed, reason: external command"),
        ("commander_disarmed_by", "Disarmed, reason: external command"),
    ]
    assert "Armed by external command\t" in [each.text for each in harness.received_of(common.Statustext)]


def test_a_refusal_to_arm_is_a_critical_event():
    harness = Px4Harness(ready=False)
    assert harness.command(CMD.COMPONENT_ARM_DISARM, 1) == RESULT.TEMPORARILY_REJECTED
    harness.run(0.2)
    assert (
        "commander_arm_denied_resolve_failures",
        "Arming refused until the failed checks pass",
    ) in decoded(harness)
    assert harness.received_of(common.Event)[-1].log_levels == 0x62


def test_a_refused_mode_is_an_event_with_the_mode():
    harness = Px4Harness()
    harness.arm()
    assert harness.set_mode(6) == RESULT.TEMPORARILY_REJECTED
    harness.run(0.2)
    assert decoded(harness)[-1] == (
        "commander_modeswitch_not_avail",
        "The mode Offboard cannot be entered now",
    )
    assert bytes(harness.received_of(common.Event)[-1].arguments)[:5] == b"\x00\x00\x06\x00\x07"


def test_a_missed_event_is_repeated_and_an_unknown_one_is_not_available():
    harness = Px4Harness()
    harness.arm()
    event = harness.received_of(common.Event)[-1]
    harness.received.clear()
    request(harness, event.sequence, event.sequence)
    assert harness.received_of(common.Event) == [event]
    request(harness, event.sequence - 1, event.sequence - 1)
    error = harness.received_of(common.ResponseEventError)[-1]
    assert (error.target_system, error.sequence_oldest_available) == (GROUND.system, event.sequence)


def test_a_reboot_resets_the_numbers():
    harness = Px4Harness()
    harness.arm()
    harness.run(3.0)
    assert harness.received_of(common.CurrentEventSequence)[-1].flags == 0
    harness.vehicle.reboot()
    harness.run(4.0)
    reset = common.MavEventCurrentSequenceFlags.RESET
    assert harness.received_of(common.CurrentEventSequence)[-1].flags == reset


@pytest.mark.parametrize("firmware", list(Firmware))
def test_only_px4_serves_events(firmware):
    names = served_metadata(firmware, VehicleType.COPTER).files
    assert any("events" in name for name in names) == (firmware is Firmware.PX4)

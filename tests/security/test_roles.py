"""The roles: every message and command of `common` is in one table, and nothing gets past a role."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.dialects import Dialect, common
from mavstack.security import SigningKey
from mavstack.security.role_tables import COMMANDS, MESSAGES
from mavstack.security.roles import Role, RoleFilter, allows, command_ids, message_ids
from mavstack.wire import Encoder, encode

COMMON = Dialect.load("common")
COMMANDS_ENUM = COMMON.enums["MAV_CMD"]
HEARTBEAT = encode(common.Heartbeat(autopilot=common.MavAutopilot.INVALID), system=255, component=190)
ROLES = {role.word for role in Role}

NOW = 1_790_000_000.0


def names(tables) -> list[str]:
    return [name for text in tables.values() for name in text.split()]


def test_every_message_is_classified_once():
    assert set(MESSAGES) == ROLES
    assert sorted(names(MESSAGES)) == sorted(message.definition.name for message in COMMON)


def test_every_command_is_classified_once():
    assert set(COMMANDS) == ROLES
    known = sorted(member.name for member in COMMANDS_ENUM)
    assert sorted(names(COMMANDS)) == known


@pytest.mark.parametrize(
    ("role", "name", "allowed"),
    [
        (Role.OBSERVE, "HEARTBEAT", True),
        (Role.OBSERVE, "REQUEST_DATA_STREAM", False),
        (Role.OBSERVE, "PARAM_REQUEST_LIST", True),
        (Role.OBSERVE, "MANUAL_CONTROL", False),
        (Role.OBSERVE, "MISSION_COUNT", False),
        (Role.OPERATE, "MANUAL_CONTROL", True),
        (Role.OPERATE, "MISSION_COUNT", True),
        (Role.OPERATE, "PARAM_SET", False),
        (Role.OPERATE, "PARAM_EXT_SET", False),
        (Role.OPERATE, "FILE_TRANSFER_PROTOCOL", False),
        (Role.OPERATE, "SERIAL_CONTROL", False),
        (Role.OPERATE, "TUNNEL", False),
        (Role.OPERATE, "HIL_GPS", False),
        (Role.OPERATE, "GPS_INPUT", False),
        (Role.OPERATE, "SETUP_SIGNING", False),
        (Role.ADMINISTER, "PARAM_SET", True),
    ],
)
def test_messages(role, name, allowed):
    assert allows(role, COMMON[name].definition.id) is allowed


COMMAND_CASES = [
    (Role.OBSERVE, "REQUEST_MESSAGE", True),
    (Role.OBSERVE, "SET_MESSAGE_INTERVAL", False),
    (Role.OBSERVE, "COMPONENT_ARM_DISARM", False),
    (Role.OPERATE, "COMPONENT_ARM_DISARM", True),
    (Role.OPERATE, "NAV_TAKEOFF", True),
    (Role.OPERATE, "DO_SET_PARAMETER", False),
    (Role.OPERATE, "PREFLIGHT_REBOOT_SHUTDOWN", False),
    (Role.OPERATE, "PREFLIGHT_CALIBRATION", False),
    (Role.OPERATE, "USER_1", False),
    (Role.ADMINISTER, "PREFLIGHT_REBOOT_SHUTDOWN", True),
]


@pytest.mark.parametrize(("role", "name", "allowed"), COMMAND_CASES)
@pytest.mark.parametrize("message", [common.CommandLong, common.CommandInt])
@pytest.mark.parametrize("version", [1, 2])
@pytest.mark.parametrize("target", [0, 1])
def test_commands_in_every_form(role, name, allowed, message, version, target):
    command = message(command=COMMANDS_ENUM[name], target_system=target, target_component=target)
    packet = encode(command, system=255, component=190, version=version)
    assert (RoleFilter(role).filter(packet, NOW) == packet) is allowed


@pytest.mark.parametrize("item", [common.MissionItem, common.MissionItemInt])
def test_a_mission_carries_no_command_that_the_role_may_not_send(item):
    operate = RoleFilter(Role.OPERATE)
    packets = {
        number: encode(item(command=number, seq=1), system=255, component=190) for number in (16, 180, 246)
    }
    assert operate.filter(b"".join(packets.values()), NOW) == packets[16]
    assert RoleFilter(Role.OBSERVE).filter(packets[16], NOW) == b""


def test_a_signature_gives_no_role():
    key = SigningKey.generate()
    encoder = Encoder(255, 190, signing=key.signing())
    packet = encoder.encode(common.CommandLong(command=246))
    assert RoleFilter(Role.OPERATE).filter(packet, NOW) == b""
    assert RoleFilter(Role.ADMINISTER).filter(packet, NOW) == packet


def test_a_command_that_is_cut_short_or_unknown_needs_administer():
    zeros = encode(common.CommandLong(), system=255, component=190)  # trimmed to one byte
    unknown = encode(common.CommandLong(command=60_000), system=255, component=190)
    assert RoleFilter(Role.OPERATE).filter(zeros + unknown, NOW) == b""


def test_a_message_of_another_dialect_needs_administer():
    packet = encode(Dialect.load("ardupilotmega")["RALLY_POINT"](), system=255, component=190)
    for role in (Role.OBSERVE, Role.OPERATE):
        kept = RoleFilter(role)
        assert kept.filter(packet + HEARTBEAT, NOW).endswith(HEARTBEAT)
        assert kept.refused == {"unknown": 1}
    assert RoleFilter(Role.ADMINISTER).filter(packet + packet, NOW) == packet + packet


@pytest.mark.parametrize("name", ["FILE_TRANSFER_PROTOCOL", "TUNNEL", "SERIAL_CONTROL", "V2_EXTENSION"])
def test_packets_inside_of_other_messages_do_not_pass(name):
    arm = encode(common.CommandLong(command=400), system=255, component=190)
    message = COMMON[name]()
    payload = message.to_payload()
    outer = COMMON[name].from_payload(payload[: -len(arm)] + arm)
    assert RoleFilter(Role.OPERATE).filter(encode(outer, system=255, component=190), NOW) == b""


@given(st.lists(st.integers(1, 40), min_size=1), st.binary(max_size=20))
def test_packets_in_parts_between_junk_are_judged_as_a_whole(sizes, junk):
    heartbeat = HEARTBEAT
    reboot = encode(common.CommandLong(command=246), system=255, component=190)
    data, kept, position, number = junk + reboot + heartbeat + reboot + heartbeat, b"", 0, 0
    role_filter = RoleFilter(Role.OPERATE)
    while position < len(data):
        size = sizes[number % len(sizes)]
        kept += role_filter.filter(data[position : position + size], NOW)
        position, number = position + size, number + 1
    assert reboot not in kept
    assert kept.count(heartbeat) * len(heartbeat) == len(kept)


def test_the_counts_of_refused_packets_are_bounded():
    role_filter = RoleFilter(Role.OPERATE)
    for command in range(50_000, 51_000):
        role_filter.filter(encode(common.CommandLong(command=command), system=255, component=190), NOW)
    assert role_filter.refused == {"COMMAND_LONG unknown": 1000}


def test_the_ids_for_rules():
    assert message_ids(Role.OBSERVE) < message_ids(Role.OPERATE)
    assert command_ids(Role.OBSERVE) < command_ids(Role.OPERATE)
    assert 246 not in command_ids(Role.OPERATE)
    assert 512 in command_ids(Role.OBSERVE)

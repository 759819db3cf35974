"""The wire of rmw_zenoh: keys, tokens and attachments as its sources describe them."""

from __future__ import annotations

from random import Random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.bridges.core.qos import DEFAULT, LATCHED, SENSOR, SERVICES, STATE
from mavstack.bridges.ros2.zenoh_keys import (
    PUBLISHER,
    SERVER,
    attachment_of,
    endpoint_token,
    gid_of,
    key_of,
    node_token,
    parse_attachment,
    parse_qos,
    parse_token,
    qos_text,
)

SESSION = "aac3178e146ba6f1fc6e6a4085e77f21"
STATE_HASH = "RIHS01_11ba7686163d22281871f1cb42557e8957407469b0be813bdb1a8922c66e3131"


def test_keys() -> None:
    assert key_of(0, "/mavros/state", "mavros_msgs/msg/State") == (
        f"0/mavros/state/mavros_msgs::msg::dds_::State_/{STATE_HASH}"
    )
    assert key_of(7, "/uav1/mavros/cmd/arming", "mavros_msgs/srv/CommandBool") == (
        "7/uav1/mavros/cmd/arming/mavros_msgs::srv::dds_::CommandBool_/"
        "RIHS01_eba73829da4af65d1019131d82f8eccae15d38717bf21409ed5187dd9bae73dc"
    )
    assert "/mavstack_msgs::action::dds_::Takeoff_SendGoal_/" in key_of(
        0, "/mavros/action/takeoff/_action/send_goal", "mavstack_msgs/action/Takeoff_SendGoal"
    )


def test_tokens() -> None:
    node = node_token(2, SESSION, 0, "", "talker")
    assert node == f"@ros2_lv/2/{SESSION}/0/0/NN/%/%/talker"
    node = node_token(0, SESSION, 1, "/mavros", "mavstack")
    assert node == f"@ros2_lv/0/{SESSION}/1/1/NN/%/%mavros/mavstack"
    token = endpoint_token(node, 5, PUBLISHER, "/mavros/state", "mavros_msgs/msg/State", qos=STATE)
    assert token == (
        f"@ros2_lv/0/{SESSION}/1/5/MP/%/%mavros/mavstack/%mavros%state/mavros_msgs::msg::dds_::State_/"
        f"{STATE_HASH}/1:1:1,10:,:,:,,"
    )


@pytest.mark.parametrize(
    ("profile", "text"),
    [
        (SENSOR, "2:2:1,5:,:,:,,"),
        (LATCHED, "1:1:1,1:,:,:,,"),
        (DEFAULT, "1:2:1,10:,:,:,,"),
        (SERVICES, "1:2:1,10:,:,:,,"),
    ],
)
def test_profiles(profile: object, text: str) -> None:
    assert qos_text(profile) == text
    parsed = parse_qos(text)
    assert (parsed.reliable, parsed.latched, parsed.depth) == (
        profile.reliable,
        profile.latched,
        profile.depth,
    )


def test_empty_parts_of_a_profile_are_its_defaults() -> None:
    parsed = parse_qos("::,7:,:,:,,")
    assert (parsed.reliable, parsed.latched, parsed.depth) == (True, False, 7)


def test_tokens_return() -> None:
    node = node_token(3, SESSION, 4, "/uav1/mavros", "param")
    entity = parse_token(node)
    assert (entity.kind, entity.namespace, entity.node) == ("NN", "/uav1/mavros", "param")
    token = endpoint_token(node, 9, SERVER, "/a/b", "std_srvs/srv/Trigger", qos=SERVICES)
    entity = parse_token(token)
    assert (entity.name, entity.dds_type) == ("/a/b", "std_srvs::srv::dds_::Trigger_")
    assert entity.qos.depth == 10


def test_attachments_are_33_bytes() -> None:
    gid = gid_of("token")
    data = attachment_of(1, 1_700_000_000_000_000_000, gid)
    assert len(data) == 33
    assert data[:8] == b"\1" + bytes(7)
    assert data[16] == 16
    assert parse_attachment(data) == (1, 1_700_000_000_000_000_000, gid)


@given(st.binary(max_size=64))
def test_any_bytes_are_an_attachment_or_none(data: bytes) -> None:
    parsed = parse_attachment(data)
    assert parsed is None or len(data) == 33


@given(st.text(alphabet="@ros2_lv/%:,0159abMPSN", max_size=80))
def test_any_key_is_a_token_or_none(key: str) -> None:
    parse_token(key)
    parse_token(f"@ros2_lv/0/{key}")


def test_damaged_tokens_raise_nothing() -> None:
    rng = Random(3)
    node = node_token(0, SESSION, 1, "/mavros", "mavstack")
    token = endpoint_token(node, 5, PUBLISHER, "/mavros/state", "mavros_msgs/msg/State", qos=STATE)
    for _ in range(300):
        letters = list(token)
        letters[rng.randrange(len(letters))] = rng.choice("/%:,@9x")
        parse_token("".join(letters))

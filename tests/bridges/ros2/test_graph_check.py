"""Findings about peers, wrong hashes and profiles that do not fit."""

from __future__ import annotations

from dataclasses import replace

import pytest

from mavstack.bridges.core.qos import DEFAULT, SENSOR, STATE, Qos
from mavstack.bridges.ros2.graph_check import check_graph
from mavstack.bridges.ros2.zenoh_keys import (
    PUBLISHER,
    SUBSCRIPTION,
    GraphEntity,
    endpoint_token,
    node_token,
    parse_token,
)

OURS, THEIRS = "aa11", "bb22"
IMU = "sensor_msgs/msg/Imu"
TWIST = "geometry_msgs/msg/TwistStamped"


def node(session: str, namespace: str, name: str) -> GraphEntity:
    return parse_token(node_token(0, session, 1, namespace, name))


def endpoint(session: str, kind: str, name: str, type_name: str, qos: Qos) -> GraphEntity:
    owner = ("/mavros", "mavstack") if session == OURS else ("", "pilot")
    token = node_token(0, session, 1, *owner)
    return parse_token(endpoint_token(token, 2, kind, name, type_name, qos=qos))


BRIDGE = [
    node(OURS, "/mavros", "mavstack"),
    endpoint(OURS, PUBLISHER, "/mavros/imu/data", IMU, SENSOR),
    endpoint(OURS, SUBSCRIPTION, "/mavros/setpoint_velocity/cmd_vel", TWIST, SENSOR),
]


def test_no_bridge() -> None:
    (found,) = check_graph([node(THEIRS, "", "pilot")], 7)
    assert not found.ok
    assert "no vehicle is in domain 7" in found.text


def test_no_peer() -> None:
    found = check_graph(BRIDGE, 0)
    assert [each.text for each in found] == [
        "/mavros/mavstack is in domain 0",
        "no other node uses a topic or service of the vehicles",
    ]


@pytest.mark.parametrize(
    ("qos", "text"),
    [
        (SENSOR, "/pilot receives /mavros/imu/data"),
        (DEFAULT, "the subscriber wants reliable samples, the bridge offers best effort"),
        (STATE, "the subscriber wants reliable samples"),
        (Qos("", reliable=False, latched=True, depth=1), "wants samples from before it joined"),
    ],
)
def test_profiles(qos: Qos, text: str) -> None:
    found = check_graph([*BRIDGE, endpoint(THEIRS, SUBSCRIPTION, "/mavros/imu/data", IMU, qos)], 0)
    assert text in found[1].text
    assert found[1].ok is (qos is SENSOR)


def test_a_publisher_of_setpoints() -> None:
    theirs = endpoint(THEIRS, PUBLISHER, "/mavros/setpoint_velocity/cmd_vel", TWIST, DEFAULT)
    found = check_graph([*BRIDGE, theirs], 0)
    assert found[1].text == "/pilot sends /mavros/setpoint_velocity/cmd_vel"


def test_another_definition_and_another_type() -> None:
    theirs = endpoint(THEIRS, SUBSCRIPTION, "/mavros/imu/data", IMU, SENSOR)
    (_, found) = check_graph([*BRIDGE, replace(theirs, hash="RIHS01_0123456789abcdef")], 0)
    assert "another definition of sensor_msgs/msg/Imu (RIHS01_01234567" in found.text
    other = endpoint(THEIRS, SUBSCRIPTION, "/mavros/imu/data", TWIST, SENSOR)
    (_, found) = check_graph([*BRIDGE, other], 0)
    assert "it uses the type geometry_msgs/msg/TwistStamped, the bridge sensor_msgs/msg/Imu" in found.text

"""The description of a vehicle for Home Assistant: its topics, ids and controls."""

from __future__ import annotations

import json

from mavstack.bridges.mqtt.groups import GROUPS
from mavstack.bridges.mqtt.home_assistant import description, discovery_topic
from mavstack.bridges.mqtt.verbs import VERBS

BASE = "mavstack/uav1"


def test_every_entity_has_an_id_of_its_own_and_topics_of_the_vehicle() -> None:
    found = description(BASE, "mavstack_uav1", "uav1", model="PX4 copter", modes=["HOLD"], control=True)
    components = found["components"].values()
    ids = [each["unique_id"] for each in components]
    assert len(set(ids)) == len(ids)
    assert all(each["platform"] and each["name"] for each in components)
    groups = {f"{BASE}/telemetry/{group}" for group in GROUPS}
    states = {each["state_topic"] for each in components if "state_topic" in each}
    assert states == groups & states | {f"{BASE}/event/text", f"{BASE}/state"}
    commands = {each["command_topic"] for each in components if "command_topic" in each}
    assert commands <= {f"{BASE}/cmd/{verb}" for verb in VERBS}
    assert json.loads(json.dumps(found)) == found


def test_the_place_has_no_state_because_each_text_of_it_would_be_the_name_of_the_place() -> None:
    found = description(BASE, "mavstack_uav1", "uav1", model="PX4 copter", modes=["HOLD"])
    assert "state_topic" not in found  # entities without a topic inherit it
    without = {name for name, each in found["components"].items() if "state_topic" not in each}
    assert without == {"place"}


def test_an_observed_vehicle_has_no_controls() -> None:
    found = description(BASE, "mavstack_uav1", "uav1", model="PX4 copter", modes=["HOLD"])
    assert not [each for each in found["components"].values() if "command_topic" in each]


def test_the_topic_is_that_of_a_device() -> None:
    assert discovery_topic("homeassistant", "mavstack_uav1") == "homeassistant/device/mavstack_uav1/config"

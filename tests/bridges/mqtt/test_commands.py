"""Requests by MQTT: which topics answers may have, limits, and requests that hold anything."""

from __future__ import annotations

import asyncio
import json
from types import SimpleNamespace
from typing import Any

from hypothesis import given
from hypothesis import strategies as st

from mavstack.bridges.mqtt.broker import Arrived
from mavstack.bridges.mqtt.commands import MAX_COMMANDS, Commands
from mavstack.security.roles import Role

BASE = "mavstack/uav1"
RESERVED = ("mavstack/", "homeassistant/")


Answer = tuple[str, dict[str, Any], bytes]
VERBS = ["arm", "goto", "mode", "mission_upload", "param_set", "mission_item", "", "\ud800", "x"]


def received(*messages: Arrived, vehicle: Any = None) -> list[Answer]:
    """The answers to messages."""
    answers: list[Answer] = []

    async def run() -> None:
        def publish(topic: str, payload: bytes, correlation: bytes) -> None:
            answers.append((topic, json.loads(payload), correlation))

        commands = Commands(vehicle, BASE, Role.ADMINISTER, publish, reserved=RESERVED)
        for message in messages:
            commands.receive(message)
        for _ in range(3):
            await asyncio.sleep(0)
        await commands.close()

    asyncio.run(run())
    return answers


def test_answers_go_to_the_response_topic_of_the_client_only() -> None:
    topics = ["client/1", "", "mavstack/uav1/status", "homeassistant/x", "a/+/b", "a/#", "$SYS/x", "x" * 600]
    messages = [Arrived(f"{BASE}/cmd/nonsense", response_topic=topic) for topic in topics]
    found = [topic for topic, *_ in received(*messages)]
    assert found == ["client/1", *[f"{BASE}/result/nonsense"] * 7]


def test_a_command_that_the_broker_kept_is_refused() -> None:
    ((_, answer, _),) = received(Arrived(f"{BASE}/cmd/arm", retained=True))
    assert answer["ok"] is False
    assert "kept this command" in answer["reason"]


def test_a_payload_that_was_discarded_is_refused() -> None:
    ((_, answer, correlation),) = received(Arrived(f"{BASE}/cmd/arm", correlation=b"7", discarded=2_000_000))
    assert answer["reason"] == "the request has 2000000 bytes, at most 1048576 are allowed"
    assert (answer["ok"], correlation) == (False, b"7")


def test_further_commands_than_the_limit_are_refused() -> None:
    async def never(**arguments: object) -> None:
        await asyncio.get_running_loop().create_future()

    messages = [Arrived(f"{BASE}/cmd/arm") for _ in range(MAX_COMMANDS + 3)]
    answers = received(*messages, vehicle=SimpleNamespace(arm=never))
    assert [answer["reason"][:22] for _, answer, _ in answers] == ["8 commands are under w"] * 3


json_values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=8), inner, max_size=3),
    max_leaves=8,
)


@given(
    st.sampled_from(VERBS),
    st.binary(max_size=40) | st.builds(lambda value: json.dumps(value).encode(), json_values),
    st.binary(max_size=4),
)
def test_any_request_is_answered(verb: str, payload: bytes, correlation: bytes) -> None:
    ((topic, answer, sent),) = received(
        Arrived(f"{BASE}/cmd/{verb}", payload, response_topic="client", correlation=correlation)
    )
    assert (topic, sent, answer["ok"]) == ("client", correlation, False)
    assert answer["reason"]


def test_deep_and_huge_requests_are_answered() -> None:
    payloads = [b"[" * 100_000, b'{"altitude": 1e999}', b'{"altitude": 1' + b"0" * 5000 + b"}"]
    payloads.append(b" " * (2 << 20))
    answers = received(*(Arrived(f"{BASE}/cmd/takeoff", payload) for payload in payloads))
    assert [answer["kind"] for _, answer, _ in answers] == ["InvalidArgumentError"] * 4


def test_the_number_of_an_item_is_whole() -> None:
    reached: list[int] = []

    async def set_current(item: int) -> None:
        reached.append(item)

    vehicle = SimpleNamespace(mission=SimpleNamespace(set_current=set_current))
    requests = [
        Arrived(f"{BASE}/cmd/mission_item", payload) for payload in (b'{"item": 0.9}', b'{"item": 2.0}')
    ]
    refused, done = [answer for _, answer, _ in received(*requests, vehicle=vehicle)]
    assert refused["reason"] == "mission_item: item must be a whole number, got 0.9"
    assert done["ok"]
    assert reached == [2]

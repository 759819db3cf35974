"""The clients of Python pass the vectors of `conformance/services.jsonl`, which those of the page pass too.

A vector is a vehicle that answers by rules, one call of a client, the messages that the client must send,
and its result or error.
"""

from __future__ import annotations

import json
from math import isnan, nan
from pathlib import Path
from typing import Any

import pytest

from mavstack.dialects import Dialect
from mavstack.errors import MavstackError
from mavstack.services import Address
from mavstack.services.command import Command, CommandClient
from mavstack.services.mission import MissionClient, MissionItem, Plan
from mavstack.services.parameters import Encoding, ParameterClient
from mavstack.services.parameters.value import field_of, with_field
from tests.services.network import GROUND, START, VEHICLE
from tests.services.single_service import packet_of, sent_by

VECTORS = Path(__file__).parents[2] / "conformance" / "services.jsonl"
CASES = [json.loads(line) for line in VECTORS.read_text("utf-8").splitlines()]
COMMON = Dialect.load("common")
#: Seconds in which each call has ended.
DEADLINE = 120.0
ENCODINGS = {"bytewise": Encoding.BYTEWISE, "cast": Encoding.C_CAST}


def message_of(name: str, fields: dict[str, Any]) -> Any:
    """Return a message; the value of a parameter is given by its bytes."""
    kind = COMMON[name]
    values = {
        key: nan if value is None else value for key, value in fields.items() if not key.startswith("@")
    }
    if hasattr(kind, "target_system"):
        values |= {"target_system": GROUND.system, "target_component": GROUND.component}
    data = values.pop("param_value", None)
    message = kind(**values)
    if data is None:
        return message
    return with_field(message, bytes.fromhex(data.removeprefix("0x")))  # type: ignore[type-var]


def name_of(message: Any) -> str:
    return str(type(message).definition.name)


def has_fields(message: Any, fields: dict[str, Any]) -> bool:
    return all(is_value(message, name, value) for name, value in fields.items())


def is_value(message: Any, name: str, value: Any) -> bool:
    if isinstance(value, str) and value.startswith("0x"):
        return field_of(message).hex() == value.removeprefix("0x")
    found = getattr(message, name)
    return isnan(found) if value is None else found == value


class ScriptedVehicle:
    """A vehicle that answers by the rules of a vector."""

    def __init__(self, rules: list[dict[str, Any]]) -> None:
        self.rules = [dict(rule) for rule in rules]

    def answers(self, message: Any) -> list[tuple[Address, Any]]:
        for rule in self.rules:
            if name_of(message) != rule["when"] or not has_fields(message, rule.get("fields", {})):
                continue
            if rule.get("lost", 0) > 0:
                rule["lost"] -= 1
                return []
            if rule.get("once"):
                self.rules.remove(rule)
            return [
                (
                    Address(VEHICLE.system, fields.get("@component", VEHICLE.component)),
                    message_of(name, fields),
                )
                for name, fields in rule["answers"]
            ]
        return []


def client_of(case: dict[str, Any]) -> Any:
    if case["service"] == "command":
        return CommandClient(GROUND, VEHICLE)
    if "encoding" in case["call"]:
        return ParameterClient(GROUND, VEHICLE, ENCODINGS[case["call"]["encoding"]])
    return MissionClient(GROUND, VEHICLE)


def start(client: Any, service: str, call: dict[str, Any]) -> Any:
    if service == "command":
        return client.command(command_of(call), START)
    if service == "get":
        return client.get(call["name"], START)
    if service == "set":
        return client.set(call["name"], call["value"], START)
    if service == "list":
        return client.download(START)
    if service == "upload":
        items = [item_of(each) for each in call["items"]]
        return client.upload(Plan.of(items, call["type"]), START)
    return getattr(client, service)(START, call["type"])


def command_of(call: dict[str, Any]) -> Command:
    params = [nan if value is None else value for value in call["params"]]
    place = call.get("place")
    if place is None:
        return Command.of(call["command"], params)
    where = [nan if place[name] is None else place[name] for name in ("latitude", "longitude", "altitude")]
    return Command.of(call["command"], [*params, *where], place["frame"])


def item_of(item: dict[str, Any]) -> MissionItem:
    params = [nan if value is None else value for value in item["params"]]
    return MissionItem(item["command"], *params, frame=item["frame"], autocontinue=item["autocontinue"])


def outcome_of(service: str, result: Any) -> Any:
    """Return the result of an operation as vectors have it."""
    if service == "command":
        return {"result": result.result, "detail": result.detail}
    if service in {"get", "set"}:
        return parameter_json(result)
    if service == "list":
        return sorted(map(parameter_json, result.values()), key=lambda each: each["name"])
    return [item_json(item) for item in result.items] if service == "download" else None


def parameter_json(parameter: Any) -> dict[str, Any]:
    return {"name": parameter.name, "value": parameter.value, "type": int(parameter.type)}


def item_json(item: MissionItem) -> dict[str, Any]:
    params = [getattr(item, f"param{number}") for number in range(1, 8)]
    return {
        "command": int(item.command),
        "frame": int(item.frame),
        "params": [None if isnan(value) else value for value in params],
        "autocontinue": item.autocontinue,
    }


def run(case: dict[str, Any]) -> tuple[Any, list[Any]]:
    """Run the call of a vector; return its operation and the messages that were sent."""
    client, vehicle = client_of(case), ScriptedVehicle(case["vehicle"])
    operation = start(client, case["service"], case["call"])
    sent: list[Any] = []
    now, sequence = START, 0
    while True:
        waiting = sent_by(client, now)
        sent += waiting
        for message in waiting:
            for source, answer in vehicle.answers(message):
                now += 0.01
                sequence = (sequence + 1) % 256
                if type(answer).definition.id in client.handles:
                    client.receive(packet_of(answer, source, sequence), now)
        if operation.done and not waiting:
            return operation, sent
        if not waiting:
            due = client.next_timeout()
            assert due is not None, "the call does not end"
            assert due < START + DEADLINE, "the call does not end in time"
            now = max(now, due)
            client.handle_timeout(now)


@pytest.mark.parametrize("case", [pytest.param(case, id=case["name"]) for case in CASES])
def test_a_client_passes_the_vector(case: dict[str, Any]) -> None:
    operation, sent = run(case)
    for name, fields in case["sends"]:
        assert any(name_of(each) == name and has_fields(each, fields) for each in sent), (name, fields)
    assert not {name_of(each) for each in sent} & set(case.get("never", ()))
    if "error" in case:
        with pytest.raises(MavstackError) as raised:
            operation.result()
        error = {"kind": type(raised.value).__name__}
        if "code" in case["error"]:
            error["code"] = int(raised.value.code)
        assert error == case["error"]
    else:
        assert outcome_of(case["service"], operation.result()) == case["result"]

from __future__ import annotations

import json
from typing import Any

import pytest

from mavstack.bridges.zenoh.router_config import Fleet, access_control, router_config
from mavstack.errors import InvalidArgumentError

FLEET = Fleet({"alpha": ("alpha",), "boat": ("beta", "gamma")}, ("map",), ("tower",), ("router",))


def rights(owner: str, fleet: Fleet = FLEET) -> list[tuple[str, str, str]]:
    """Return message, flow and key of all that is allowed to the owner of a certificate."""
    found = access_control(fleet)
    subjects = {each["id"] for each in found["subjects"] if owner in each["cert_common_names"]}
    ids = {rule for each in found["policies"] if subjects & set(each["subjects"]) for rule in each["rules"]}
    return [
        (message, flow, key)
        for rule in found["rules"]
        if rule["id"] in ids
        for message in rule["messages"]
        for flow in rule["flows"]
        for key in rule["key_exprs"]
    ]


def written(owner: str) -> set[str]:
    """Return the keys to which an owner may put or declare something."""
    kinds = ("put", "delete", "reply", "declare_queryable", "liveliness_token")
    return {key for message, flow, key in rights(owner) if flow == "ingress" and message in kinds}


def test_everything_else_is_denied() -> None:
    found = access_control(FLEET)
    assert (found["enabled"], found["default_permission"]) == (True, "deny")
    assert rights("mallory") == []


def test_a_vehicle_writes_its_own_keys_only() -> None:
    own = {"mavstack/alpha/**", "mavstack/alpha/state/*/@adv/**", "mavstack/@gateway/*"}
    assert written("alpha") == own
    beta = {key for key in written("boat") if "@" not in key}
    assert beta == {"mavstack/beta/**", "mavstack/gamma/**"}
    asked = {key for message, flow, key in rights("alpha") if flow == "ingress" and message == "query"}
    assert asked == set()
    received = {key for message, flow, key in rights("alpha") if flow == "egress" and message == "put"}
    assert received == {"mavstack/alpha/frame/in"}


def test_stations_read_and_only_pilots_control() -> None:
    assert written("map") == set()
    asked = {key for message, flow, key in rights("map") if flow == "ingress" and message == "query"}
    assert not any(
        "command" in key or "frame/in" in key or (key.endswith("/**") and "@" not in key) for key in asked
    )
    assert written("tower") == {"mavstack/*/frame/in", "mavstack/*/command/**"}


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        ({"gateways": {"a": ("a",)}, "pilots": ("a",)}, "has two roles"),
        ({"gateways": {"a": ("v",), "b": ("v",)}}, "two gateways serve the vehicle 'v'"),
        ({"gateways": {"a/b": ("a",)}}, "must have letters"),
        ({"gateways": {"a": ("*",)}}, "must have letters"),
        ({"gateways": {"a": ("a",)}, "prefix": "x//y"}, "must have letters"),
    ],
)
def test_fleets_that_contradict_themselves(arguments: dict[str, Any], reason: str) -> None:
    with pytest.raises(InvalidArgumentError, match=reason):
        Fleet(**arguments)


def test_the_configuration_is_json_with_mutual_tls() -> None:
    text = router_config(
        FLEET, certificate="/f/r.pem", private_key="/f/r.key", ca="/f/ca.pem", connect=["tls/10.1.0.1:7447"]
    )
    config = json.loads(text)
    assert config["mode"] == "router"
    assert config["transport"]["link"]["tls"]["enable_mtls"] is True
    assert config["listen"]["endpoints"] == ["tls/0.0.0.0:7447"]
    assert config["connect"]["endpoints"] == ["tls/10.1.0.1:7447"]
    zenoh = pytest.importorskip("zenoh")
    zenoh.Config.from_json5(text)

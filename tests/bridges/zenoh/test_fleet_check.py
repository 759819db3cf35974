from __future__ import annotations

from mavstack.bridges.zenoh.fleet_check import check_tokens

GATEWAYS = ["mavstack/@gateway/boat", "mavstack/@gateway/tower"]


def texts(*keys: str) -> list[tuple[bool, str]]:
    return [(each.ok, each.text) for each in check_tokens("mavstack", keys)]


def test_gateways_and_their_vehicles() -> None:
    tokens = ["mavstack/alpha/alive/tower", "mavstack/beta/alive/tower"]
    assert texts(*GATEWAYS, *tokens) == [
        (False, "gateway boat hears no vehicle"),
        (True, "gateway tower serves alpha, beta"),
    ]


def test_one_name_for_two_vehicles() -> None:
    tokens = ["mavstack/sys1/alive/tower", "mavstack/sys1/alive/boat"]
    assert texts(*GATEWAYS, *tokens)[-1] == (
        False,
        "boat and tower serve a vehicle sys1, and pass no commands on; use --name",
    )


def test_no_gateway() -> None:
    ((ok, text),) = texts("other/@gateway/tower", "other/alpha/alive/tower")
    assert not ok
    assert text.startswith("no gateway serves the fleet mavstack")

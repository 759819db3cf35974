from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mavstack.router.changes import Add, NeedsRestart, Reconfigure, Remove, applicable, steps_between
from mavstack.router.config import EndpointConfig, PacketFilter, RouterConfig

A = EndpointConfig("a", "udpin://127.0.0.1:1")
B = EndpointConfig("b", "udpin://127.0.0.1:2")
OTHER_URL = replace(A, url="udpin://127.0.0.1:3")
PAUSED = replace(A, pause=True)
VARIANTS = [
    PAUSED,
    replace(A, group="radio"),
    replace(A, rate=100.0),
    replace(A, rates=((30, 1.0),)),
    replace(A, listen_only=True),
    replace(A, incoming=PacketFilter(deny_systems=frozenset({1}))),
]


def config(*endpoints: EndpointConfig, **settings: object) -> RouterConfig:
    return RouterConfig(endpoints, **settings)


def test_unchanged_endpoints_have_no_steps():
    assert steps_between(config(A, B), config(B, A)) == ()


@pytest.mark.parametrize("variant", VARIANTS)
def test_filters_and_states_change_while_the_link_is_open(variant):
    assert steps_between(config(A, B), config(variant, B)) == (Reconfigure(variant),)


@pytest.mark.parametrize("variant", [OTHER_URL, replace(A, high_latency=5.0)])
def test_another_transport_is_opened_again(variant):
    assert steps_between(config(A, B), config(variant, B)) == (Remove("a"), Add(variant))


def test_removals_come_first_so_that_a_port_can_move():
    moved = replace(B, url=A.url)
    assert steps_between(config(A), config(moved)) == (Remove("a"), Add(moved))


def test_settings_of_the_start():
    old, new = config(A), config(A, dialect="common", watch=False)
    assert steps_between(old, new) == (NeedsRestart("dialect"),)
    assert applicable(old, new) == replace(new, dialect="all")


ENDPOINTS = st.lists(st.sampled_from([A, B, OTHER_URL, *VARIANTS]), unique_by=lambda each: each.name)


@pytest.mark.properties
@settings(max_examples=40)
@given(ENDPOINTS, ENDPOINTS)
def test_the_steps_lead_from_one_to_the_other(old, new):
    endpoints = {each.name: each for each in old}
    for step in steps_between(config(*old), config(*new)):
        match step:
            case Remove(name):
                del endpoints[name]
            case Add(endpoint):
                assert endpoint.name not in endpoints
                endpoints[endpoint.name] = endpoint
            case Reconfigure(endpoint):
                assert endpoints[endpoint.name].url == endpoint.url
                endpoints[endpoint.name] = endpoint
    assert endpoints == {each.name: each for each in new}

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mavstack.router.config import (
    EndpointConfig,
    PacketFilter,
    Recording,
    RouterConfig,
    parse_config,
    toml_text,
)

NUMBERS = st.frozensets(st.integers(1, 250), max_size=4)
FILTERS = st.builds(
    PacketFilter,
    allow_messages=NUMBERS,
    allow_systems=NUMBERS,
    deny_components=NUMBERS,
    deny_commands=NUMBERS,
)
QUANTITIES = st.integers(1, 10**9).map(lambda number: number / 1000)
TEXTS = st.text(st.characters(exclude_categories=["Cs"]), max_size=8)
LINKS = st.builds(
    EndpointConfig,
    name=st.just(""),
    url=st.just("udpout://127.0.0.1:14550"),
    group=TEXTS,
    listen_only=st.booleans(),
    pause=st.booleans(),
    rate=st.none() | QUANTITIES,
    rates=st.dictionaries(st.integers(0, 400), QUANTITIES, max_size=3).map(
        lambda each: tuple(sorted(each.items()))
    ),
    incoming=FILTERS,
    outgoing=FILTERS,
    high_latency=st.none() | QUANTITIES,
)
RECORDERS = st.builds(
    EndpointConfig,
    name=st.just(""),
    record=st.builds(
        Recording, path=TEXTS.filter(bool), max_size=st.integers(1, 10**9), keep=st.integers(1, 9)
    ),
)
NAMES = st.from_regex(r"[A-Za-z0-9][A-Za-z0-9_.-]{0,8}", fullmatch=True)
CONFIGS = st.builds(
    RouterConfig,
    endpoints=st.dictionaries(NAMES, LINKS | RECORDERS, max_size=4).map(
        lambda found: tuple(replace(each, name=name) for name, each in found.items())
    ),
    duplicate_window=st.integers(0, 10_000).map(lambda number: number / 1000),
    control_token=TEXTS,
    metrics=st.booleans(),
    watch=st.booleans(),
)


@pytest.mark.properties
@settings(max_examples=10, deadline=None)
@given(CONFIGS)
def test_every_configuration_is_read_back(config):
    assert parse_config(toml_text(config)) == config


def test_names_are_written():
    text = toml_text(RouterConfig((EndpointConfig("a", "udpout://127.0.0.1:1", rates=((30, 4.0),)),)))
    assert text == '[endpoint.a]\nurl = "udpout://127.0.0.1:1"\n\n[endpoint.a.rates]\nATTITUDE = 4\n'

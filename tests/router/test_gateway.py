"""The signing gateway: keys and timestamps of each endpoint."""

from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.errors import RouterConfigError, SigningError
from mavstack.router import gateway as gateway_module
from mavstack.router.config import (
    EndpointConfig,
    RouterConfig,
    SigningConfig,
    Table,
    parse_config,
    toml_text,
)
from mavstack.router.config.names import Names
from mavstack.router.config.signing import read_signing
from mavstack.router.gateway import Gateway
from mavstack.security import SigningKey, TimestampStore, key_store
from mavstack.wire import Encoder, Parser
from tests.router.peers import routing

NOW = 1_790_000_000.0


class Engine:
    """Takes what the gateway sets."""

    def __init__(self) -> None:
        self.signing: dict[int, tuple] = {}

    def set_signing(self, endpoint, incoming=None, outgoing=None, *, allow_unsigned=(), strip=True) -> None:
        self.signing[endpoint] = (incoming, outgoing, list(allow_unsigned), strip)


@pytest.fixture(autouse=True)
def _keys(tmp_path, monkeypatch):
    monkeypatch.setattr(key_store, "key_directory", lambda: tmp_path / "keys")
    for name in ("field", "fleet"):
        key_store.store_key(name, SigningKey.from_passphrase(name))


def read(text: str) -> SigningConfig:
    return read_signing(Table.parse(text, "router.toml"), Names("common"))


def opened(store=None) -> tuple[Gateway, Engine]:
    return Gateway(store), Engine()


def test_the_configuration_is_read():
    config = read('in = "field"\nout = "fleet"\nallow_unsigned = ["HEARTBEAT"]\nstrip = false')
    assert config == SigningConfig("field", "fleet", frozenset({0}), strip=False)
    assert read('in = "field"').allow_unsigned == frozenset({109})


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("", "needs a key"),
        ('in = "nosuch"', "there is no signing key 'nosuch'"),
        ('in = "field"\nunsigned = true', "unsigned is unknown"),
        ('in = "field"\nallow_unsigned = ["RADIO"]', "there is no message 'RADIO'"),
    ],
)
def test_a_bad_configuration_is_refused_with_its_place(text, problem):
    with pytest.raises(RouterConfigError, match=r"router\.toml:|needs") as error:
        read(text)
    assert problem in str(error.value)


def test_an_endpoint_verifies_with_one_key_and_signs_with_another():
    gateway, engine = opened()
    gateway.apply(engine, 1, SigningConfig("field", "fleet"), NOW)
    incoming, outgoing, allowed, strip = engine.signing[1]
    assert (allowed, strip) == ([109], True)
    sender = Encoder(255, 190, signing=SigningKey.from_passphrase("field").signing())
    assert (
        len(Parser(common, signing=incoming).feed(sender.encode(common.Heartbeat(), NOW + 1), NOW + 1)) == 1
    )
    signed = Encoder(1, 1, signing=outgoing).encode(common.Heartbeat(), NOW + 1)
    fleet = SigningKey.from_passphrase("fleet").signing()
    assert len(Parser(common, signing=fleet).feed(signed, NOW + 1)) == 1
    gateway.apply(engine, 1, None, NOW)
    assert engine.signing[1][:2] == (None, None)


@pytest.mark.parametrize("version", [1, 2])
def test_unsigned_packets_of_either_version_are_refused(version):
    gateway, engine = opened()
    gateway.apply(engine, 1, SigningConfig("field"), NOW)
    parser = Parser(common, signing=engine.signing[1][0])
    sender = Encoder(255, 190, version=version)
    assert parser.feed(sender.encode(common.CommandLong(command=400), NOW + 1), NOW + 1) == []


def test_a_packet_of_one_link_is_a_replay_on_another():
    gateway, engine = opened()
    for endpoint in (1, 2):
        gateway.apply(engine, endpoint, SigningConfig("field"), NOW)
    sender = Encoder(255, 190, signing=SigningKey.from_passphrase("field").signing())
    packet = sender.encode(common.CommandLong(command=400), NOW + 1)
    counts = [len(Parser(common, signing=engine.signing[each][0]).feed(packet, NOW + 1)) for each in (1, 2)]
    assert counts == [1, 0]


@pytest.mark.parametrize("ended", [True, False])
def test_packets_of_the_last_run_are_refused(tmp_path, ended):
    sender = Encoder(255, 190, signing=SigningKey.from_passphrase("field").signing())
    packet = sender.encode(common.CommandLong(command=400), NOW + 1)
    gateway, engine = opened(lambda: TimestampStore(tmp_path / "times"))
    gateway.apply(engine, 1, SigningConfig("field"), NOW)
    assert len(Parser(common, signing=engine.signing[1][0]).feed(packet, NOW + 1)) == 1
    if ended:
        gateway.store(running=False)
    gateway, engine = opened(lambda: TimestampStore(tmp_path / "times"))
    gateway.apply(engine, 1, SigningConfig("field"), NOW + 5)
    assert Parser(common, signing=engine.signing[1][0]).feed(packet, NOW + 5) == []


def test_a_url_names_the_key_of_both_directions():
    (found,) = parse_config('[endpoint.a]\nurl = "udpin://127.0.0.1:1?signing_key=field"\n').endpoints
    assert (found.signing, found.keys) == (None, SigningConfig("field", "field"))
    assert parse_config(toml_text(RouterConfig((found,)))).endpoints == (found,)


@pytest.mark.parametrize(
    ("url", "more", "problem"),
    [
        ("?signing_key=nosuch", "", "signing_key is no key: there is no signing key 'nosuch'"),
        ("?signing_key=field", '[endpoint.a.signing]\nin = "field"', "both name keys: leave one out"),
        ("?id=7", "", "a router sends no packets of its own: leave id out"),
        ("?mavlink=1", "", "leave mavlink out"),
    ],
)
def test_options_of_a_url_without_effect_are_refused(url, more, problem):
    with pytest.raises(RouterConfigError, match=problem):
        parse_config(f'[endpoint.a]\nurl = "udpin://127.0.0.1:1{url}"\n{more}\n')


def test_the_signing_of_endpoints_is_written():
    configs = [
        SigningConfig("field"),
        SigningConfig("", "fleet"),
        SigningConfig("field", "fleet", frozenset({0, 109}), strip=False),
    ]
    config = RouterConfig(
        tuple(EndpointConfig(f"e{i}", "udpin://127.0.0.1:1", signing=each) for i, each in enumerate(configs))
    )
    assert parse_config(toml_text(config)) == config


def test_keys_are_read_once_and_again_on_demand():
    gateway, engine = opened()
    config = SigningConfig("field", "fleet")
    assert not gateway.load_keys([config])
    key_store.delete_key("field")
    gateway.apply(engine, 3, config, NOW)  # a client that connects later needs no file
    assert None not in engine.signing[3][:2]
    with pytest.raises(SigningError, match="no signing key 'field'"):
        gateway.load_keys([config])
    key_store.store_key("field", SigningKey.from_passphrase("field"))
    assert not gateway.load_keys([config])
    key_store.replace_key("field", SigningKey.from_passphrase("another"))
    assert gateway.load_keys([config])


async def test_only_a_router_with_keys_needs_a_directory_for_its_state(tmp_path, monkeypatch):
    (no_directory := tmp_path / "file").touch()
    monkeypatch.setattr(gateway_module, "key_directory", lambda: no_directory / "keys")
    SigningKey.from_passphrase("field").save(tmp_path / "field.key")
    url = "udpin://127.0.0.1:0"
    async with routing(EndpointConfig("plain", url)) as router:
        with pytest.raises(SigningError, match=r"cannot create .*file for the signing timestamps"):
            await router.add(EndpointConfig("signed", f"{url}?signing_key={tmp_path / 'field.key'}"))

"""The firewall and the gateway, with the real engine."""

from __future__ import annotations

import logging
import select
from dataclasses import replace
from functools import partial
from time import monotonic, sleep

import pytest

from mavstack.dialects import common
from mavstack.errors import RouterConfigError
from mavstack.router import RouterEngine, Rule, RuleSet
from mavstack.router.config import EndpointConfig, RouterConfig, parse_config
from mavstack.router.firewall import Peer
from mavstack.router.firewall.id_store import IdStore
from mavstack.router.guard import Guard
from mavstack.security import SigningKey
from mavstack.wire import Encoder, Parser
from tests.router.packets import unknown

NOW = 1_790_000_000.0
CONFIG = """
[router]
dialect = "common"
[endpoint.vehicle]
url = "udpin://127.0.0.1:1"
[endpoint.ground]
url = "tcpin://127.0.0.1:2"
[firewall]
statustext = true
quarantine = "10 s"
[[firewall.rule]]
endpoints = ["vehicle"]
systems = [1]
[[firewall.rule]]
name = "pilot"
endpoints = ["ground"]
from = ["10.0.0.0/8"]
systems = [255]
messages = ["HEARTBEAT", "COMMAND_LONG", "HIL_GPS"]
"""
NO_COMMANDS = RuleSet(incoming=(Rule("drop", messages=frozenset({76}), name="in.deny_messages"),))


class Setup:
    """A router's engine with a vehicle, a pilot and a stranger."""

    def __init__(self, engine: RouterEngine, own: RuleSet | None = None) -> None:
        self.engine = engine
        self.own = own or RuleSet()
        self.config = parse_config(CONFIG)
        self.guard = Guard(engine, self.config, self.rules_of)
        self.guard.open(NOW)
        self.vehicle = self.add("vehicle", "vehicle")
        self.pilot = self.add("ground", "ground 10.0.0.1:5", Peer("10.0.0.1", 5))
        self.stranger = self.add("ground", "ground 192.0.2.1:5", Peer("192.0.2.1", 5))
        self.send(self.vehicle, Encoder(1, 1), common.Heartbeat(type=2, autopilot=3))

    def rules_of(self, endpoint: EndpointConfig) -> RuleSet:
        """The filter of the ground endpoint."""
        return self.own if endpoint.name == "ground" else RuleSet()

    def add(self, endpoint: str, name: str, peer: Peer | None = None) -> int:
        number = self.engine.add_queue(name=name)
        self.guard.add(number, name, peer)
        self.guard.configure(number, self.config.endpoint(endpoint))
        return number

    def send(self, number: int, encoder: Encoder, message) -> None:
        """Send a message, and handle all events that it causes."""
        self.engine.push(number, encoder.encode(message, NOW))
        self.settle()

    def settle(self) -> None:
        self.engine.statistics()  # waits for one turn of the engine
        end = monotonic() + 10
        while select.select([self.engine.fileno()], [], [], 0.02)[0] and monotonic() < end:
            for event in self.engine.events():
                self.guard.handle_event(event, NOW)
            self.engine.statistics()

    def names(self, number: int) -> list[str]:
        """The messages that wait for a link."""
        data = b"".join(self.engine.pull(number))
        return [packet.name for packet in Parser(common).feed(data)]


@pytest.fixture
def setup():
    with RouterEngine(common) as engine:
        yield Setup(engine)


def test_commands_of_the_pilot_pass_and_those_of_a_stranger_do_not(setup):
    arm = common.CommandLong(target_system=1, target_component=1, command=400, param1=1)
    for number in (setup.stranger, setup.pilot):
        setup.send(number, Encoder(255, 190), common.Heartbeat(type=6, autopilot=8))
        setup.send(number, Encoder(255, 190), arm)
    assert setup.names(setup.vehicle) == ["STATUSTEXT", "HEARTBEAT", "COMMAND_LONG"]
    assert setup.names(setup.stranger) == []  # it does not even hear the vehicle
    assert "HEARTBEAT" in setup.names(setup.pilot)


NOT_ALLOWED = (
    common.Tunnel(target_system=1, target_component=1, payload_length=1),
    common.FileTransferProtocol(target_system=1, target_component=1),
    common.CommandInt(target_system=1, target_component=1, command=400),
    common.CommandInt(command=400),  # to all
    common.SetMode(target_system=1),
    common.SerialControl(),
    common.ParamSet(target_system=1),
)


def forms(encoder_of, messages) -> list[bytes]:
    """The packets of messages in all forms: both versions, signed, and one of an unknown message."""
    key = SigningKey(bytes(32)).signing(timestamp=1)
    encoders = (encoder_of(), encoder_of(version=1), encoder_of(signing=key))
    known = [
        encoder.encode(message, NOW)
        for message in messages
        for encoder in encoders
        if encoder is not encoders[1] or type(message).definition.id < 256
    ]
    return [*known, unknown(encoder_of())]


def test_what_no_rule_names_is_dropped_in_every_form(setup):
    setup.names(setup.vehicle)
    allowed = (common.Heartbeat(type=6), common.CommandLong(target_system=1, command=400))
    packets = forms(partial(Encoder, 255, 190), NOT_ALLOWED)
    packets += forms(partial(Encoder, 254, 190), (*NOT_ALLOWED, *allowed))
    packets += forms(partial(Encoder, 0, 0), (*NOT_ALLOWED, *allowed))
    setup.engine.push(setup.pilot, b"".join(packets))
    setup.engine.push(setup.stranger, b"".join(forms(partial(Encoder, 255, 190), (*NOT_ALLOWED, *allowed))))
    setup.settle()
    counted = setup.engine.statistics().endpoints
    assert counted[setup.pilot].received == len(packets)
    assert set(setup.names(setup.vehicle)) == {"STATUSTEXT"}


def test_an_injected_position_is_dropped_reported_and_its_sender_quarantined(setup, caplog):
    alerts = []
    setup.guard.on_alert = alerts.append
    pilot = Encoder(255, 190)
    with caplog.at_level(logging.WARNING, "mavstack.router.firewall"):
        setup.send(setup.pilot, pilot, common.HilGps())
    assert "HIL_GPS from a sender that is not allowed" in caplog.text
    assert (alerts[0].detector, setup.guard.counts["injected-positions"]) == ("injected-positions", 1)
    setup.settle()
    assert set(setup.names(setup.vehicle)) == {"STATUSTEXT"}
    setup.send(setup.pilot, pilot, common.Heartbeat(type=6, autopilot=8))
    assert set(setup.names(setup.vehicle)) == {"STATUSTEXT"}
    setup.guard.handle_timer(NOW + 11)
    setup.send(setup.pilot, pilot, common.Heartbeat(type=6, autopilot=8))
    assert "HEARTBEAT" in setup.names(setup.vehicle)


def wait_for_drops(engine, endpoint, count):
    """Wait until the engine's thread has refused packets of an endpoint."""
    for _ in range(3000):
        if engine.statistics().endpoints[endpoint].dropped["unsigned"] >= count:
            return
        sleep(0.01)


def test_a_flood_without_the_key_does_not_cut_off_the_link_of_a_signed_pilot(tmp_path):
    """A radio carries the packets of the pilot and those of other programs."""
    key = SigningKey.from_passphrase("of the pilot")
    key.save(tmp_path / "field.key")
    text = CONFIG.replace(
        'url = "tcpin://127.0.0.1:2"',
        f"""url = "tcpin://127.0.0.1:2"
[endpoint.ground.signing]
in = "{tmp_path / "field.key"}"
""",
    )
    with RouterEngine(common) as engine:
        guard = Guard(engine, config := parse_config(text), lambda endpoint: RuleSet())
        guard.load_keys(config)
        guard.open(NOW)
        ground = engine.add_queue(name="ground", capacity=20_000)
        guard.add(ground, "ground", Peer("10.0.0.1", 5))
        guard.configure(ground, config.endpoint("ground"))
        for second in range(3):
            guard.handle_timer(NOW + second)
            junk = Encoder(255, 190).encode(common.Heartbeat(type=6)) + bytes(100)
            engine.push(ground, junk * 6000)
            wait_for_drops(engine, ground, 5000 * (second + 1))
        guard.handle_timer(NOW + 3)
        assert engine.statistics().endpoints[ground].dropped["unsigned"] >= 15_000
        assert not any(rule.name.endswith("quarantine") for rule in guard.firewall.rules("ground"))


def test_what_a_rule_drops_is_reported_once(setup, caplog):
    with caplog.at_level(logging.WARNING, "mavstack.router.firewall"):
        for _ in range(5):
            setup.send(setup.pilot, Encoder(255, 190), common.Attitude())
    assert caplog.text.count("firewall.default: ground 10.0.0.1:5 255/190: ATTITUDE dropped") == 1


def test_the_filter_of_an_endpoint_holds_too():
    with RouterEngine(common) as engine:
        setup = Setup(engine, own=NO_COMMANDS)
        setup.send(setup.pilot, Encoder(255, 190), common.Heartbeat(type=6, autopilot=8))
        setup.send(setup.pilot, Encoder(255, 190), common.CommandLong(target_system=1, command=400))
        assert "HEARTBEAT" in (names := setup.names(setup.vehicle))
        assert "COMMAND_LONG" not in names


def test_rules_for_unknown_endpoints_are_refused():
    config = parse_config(CONFIG.replace('endpoints = ["vehicle"]', 'endpoints = ["vehicel"]'))
    with (
        RouterEngine(common) as engine,
        pytest.raises(RouterConfigError, match="names 'vehicel', which is no"),
    ):
        Guard(engine, config, lambda endpoint: RuleSet())


def test_without_a_firewall_the_filters_hold_alone():
    with RouterEngine(common) as engine:
        guard = Guard(engine, RouterConfig(), lambda endpoint: NO_COMMANDS)
        guard.open(NOW)
        number = engine.add_queue(name="any")
        guard.configure(number, EndpointConfig("any", "udpin://127.0.0.1:1"))
        guard.handle_timer(NOW)
        guard.close()
        assert guard.counts == {}
        assert engine.statistics().endpoints[number].incoming_rules[0].name == "in.deny_messages"


def test_a_reload_replaces_the_rules_and_an_invalid_one_changes_nothing(setup):
    with pytest.raises(RouterConfigError, match="must be one of deny"):
        setup.guard.reload(parse_config(CONFIG.replace("statustext = true", 'default = "block"')))
    setup.send(setup.pilot, Encoder(255, 190), common.Attitude())
    assert "ATTITUDE" not in setup.names(setup.vehicle)
    setup.guard.reload(replace(setup.config, firewall=None))
    setup.guard.configure(setup.pilot, setup.config.endpoint("ground"))
    setup.send(setup.pilot, Encoder(255, 190), common.Attitude())
    assert "ATTITUDE" in setup.names(setup.vehicle)


@pytest.mark.parametrize(
    ("quarantine", "released"),
    [('quarantine = "1 min"', False), ("dry_run = true", True), ("", True)],
)
def test_a_reload_keeps_quarantines(setup, quarantine, released):
    pilot = Encoder(255, 190)
    setup.send(setup.pilot, pilot, common.HilGps())
    setup.settle()
    setup.names(setup.vehicle)
    setup.guard.reload(parse_config(CONFIG.replace('quarantine = "10 s"', quarantine)))
    setup.guard.configure(setup.pilot, setup.config.endpoint("ground"))
    setup.send(setup.pilot, pilot, common.Heartbeat(type=6, autopilot=8))
    assert ("HEARTBEAT" in setup.names(setup.vehicle)) is released
    setup.guard.handle_timer(NOW + 11)  # as long as the quarantine was when it began
    setup.send(setup.pilot, pilot, common.Heartbeat(type=6, autopilot=8))
    assert "HEARTBEAT" in setup.names(setup.vehicle)


def test_a_reload_never_lets_all_peers_in_for_a_moment(setup, monkeypatch):
    given = []
    monkeypatch.setattr(type(setup.engine), "set_allowed_peers", lambda _, *call: given.append(call))
    number = setup.engine.add_queue(name="listener")
    setup.guard.add(number, "listener", None, listening=True)
    ground = setup.config.endpoint("ground")
    setup.guard.configure(number, ground)
    setup.guard.reload(setup.config)
    setup.guard.configure(number, ground)
    ranges = [("10.0.0.0", 8, 0, 65_535)]
    assert given == [(number, ranges), (number, ranges)]
    setup.guard.reload(replace(setup.config, firewall=None))
    setup.guard.configure(number, ground)
    assert given[-1] == (number, None)


WITH_IDS = CONFIG.replace("[[firewall", '[firewall.ids]\npool = "200-201"\n[[firewall', 1)


def guard_with_ids(engine, path) -> Guard:
    guard = Guard(engine, parse_config(WITH_IDS), lambda endpoint: RuleSet(), ids=lambda: IdStore(path))
    guard.open(NOW)
    return guard


def connect(guard: Guard, credential: str) -> dict[str, int]:
    """Connect a station with a credential, and return all assigned ids."""
    number = guard._engine.add_queue(name=credential)
    guard.add(number, f"ground {credential}", Peer("10.0.0.1", number), credential=credential)
    guard.configure(number, parse_config(WITH_IDS).endpoint("ground"))
    return guard.firewall.ids.ids


def test_ids_of_ground_stations_are_kept_for_the_next_run(tmp_path, caplog):
    path = tmp_path / "router.ids"
    with RouterEngine(common) as engine:
        guard = guard_with_ids(engine, path)
        assert not path.exists()
        assert connect(guard, "ann") == {"ann": 200}
    with RouterEngine(common) as engine:
        guard = guard_with_ids(engine, path)
        assert connect(guard, "bob") == {"ann": 200, "bob": 201}
        assert connect(guard, "carl") == {"ann": 200, "bob": 201}  # it is refused, and the others stay
        guard.reload(guard_config := parse_config(WITH_IDS))
        assert guard.firewall.ids.ids == {"ann": 200, "bob": 201}
        path.write_text("{")
        with pytest.raises(RouterConfigError, match="no assigned system ids"):
            guard.reload(guard_config)


def test_ids_that_cannot_be_stored_are_logged(tmp_path, caplog):
    with RouterEngine(common) as engine, caplog.at_level(logging.ERROR, "mavstack.router.firewall"):
        (tmp_path / "file").touch()
        guard = guard_with_ids(engine, tmp_path / "router.ids")
        guard._ids = lambda: IdStore(tmp_path / "file" / "router.ids")
        assert connect(guard, "ann") == {"ann": 200}
    assert "cannot write" in caplog.text


def test_a_reload_turns_status_texts_on_and_off(setup):
    quiet = parse_config(CONFIG.replace("statustext = true", ""))
    for config, expected in ((quiet, []), (parse_config(CONFIG), ["STATUSTEXT"])):
        setup.guard.reload(config)
        for number, endpoint in ((setup.vehicle, "vehicle"), (setup.pilot, "ground")):
            setup.guard.configure(number, setup.config.endpoint(endpoint))
        setup.settle()
        setup.names(setup.vehicle)
        setup.send(setup.pilot, Encoder(255, 190), common.HilGps())
        setup.settle()
        assert setup.names(setup.vehicle) == expected

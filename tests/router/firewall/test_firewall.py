"""The firewall: rules from TOML, decisions about inspected packets, quarantine, dry run, alerts."""

from __future__ import annotations

from dataclasses import replace
from importlib import resources

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.dialects import Dialect, common, minimal
from mavstack.errors import RouterConfigError
from mavstack.router.config import Table
from mavstack.router.config.names import Names
from mavstack.router.firewall import Firewall, Peer, Traffic, read_firewall
from mavstack.router.firewall.compiler import (
    ambiguous_rules,
    deciding_rule,
    engine_rules,
    peer_ranges,
    with_filter,
)
from mavstack.router.firewall.detector import Detector
from mavstack.router.firewall.quarantine import Remote
from mavstack.router.rules import Rule, RuleSet
from mavstack.services import message_ids
from mavstack.wire import Packet
from tests.router.firewall.packets import Sender, command, ground_heartbeat, heartbeat

ARM, TAKEOFF, PARAM_SET, HEARTBEAT = 400, 22, 23, 0
NAMES = Names("common")
PILOT = """
[firewall]
default = "deny"
[[firewall.rule]]
name = "vehicle"
endpoints = ["autopilot"]
systems = [1]
[[firewall.rule]]
name = "no takeoff"
commands = ["NAV_TAKEOFF"]
action = "deny"
[[firewall.rule]]
name = "pilot"
from = ["10.1.0.0/16"]
ports = "14550-14560"
systems = [255]
messages = ["HEARTBEAT", "COMMAND_LONG"]
"""


def with_options(*lines: str) -> str:
    """The rules of the pilot with options of the firewall."""
    return PILOT.replace("[firewall]", "\n".join(["[firewall]", *lines]), 1)


def configured(text: str):
    return read_firewall(Table.parse(text, "router.toml").table("firewall"), NAMES)


def firewall(text: str = PILOT, **options) -> Firewall:
    made = Firewall(configured(text))
    made.open_endpoint("autopilot")
    made.open_endpoint("ground", Peer("10.1.2.3", 14550), **options)
    return made


def decide(made: Firewall, message, *, source=(255, 190), name="ground", now=0.0) -> bool:
    return made.decide(name, Sender(*source).packet(message), now)


def test_what_no_rule_allows_is_dropped():
    made = firewall()
    assert decide(made, ground_heartbeat())
    assert decide(made, command(ARM, 1))
    assert decide(made, heartbeat(), source=(1, 1), name="autopilot")
    assert not decide(made, command(TAKEOFF))
    assert not decide(made, common.ParamSet(target_system=1, target_component=1, param_id="A"))
    assert not decide(made, command(ARM, 1), source=(254, 190))
    assert not decide(made, heartbeat(), source=(2, 1), name="autopilot")
    assert not decide(made, heartbeat(), name="unknown")
    assert {alert.detector for alert in made.alerts()} == {"firewall.no takeoff", "firewall.default"}


def test_the_engine_gets_the_rules_of_the_endpoint_and_its_peer():
    made = firewall()
    inspect, takeoff, pilot, default, _ = made.rules("ground")
    assert (inspect.action, common.CommandLong.__mavlink_row__[0] in inspect.messages) == ("inspect", True)
    assert 30 not in inspect.messages  # telemetry is not inspected
    assert (takeoff.action, takeoff.commands) == ("drop", frozenset({TAKEOFF}))
    assert (pilot.action, pilot.messages, pilot.systems) == ("pass", frozenset({0, 76}), frozenset({255}))
    assert (default.action, default.name) == ("drop", "firewall.default")


@pytest.mark.parametrize(
    ("host", "port", "admitted"),
    [
        ("10.1.2.3", 14550, True),
        ("::ffff:10.1.2.3", 14550, True),
        ("10.2.0.1", 14550, False),
        ("10.1.2.3", 14561, False),
        ("fe80::1%eth0", 14550, False),
        ("not an address", 14550, False),
    ],
)
def test_a_peer_that_no_rule_allows_is_refused(host, port, admitted):
    made = Firewall(configured(PILOT))
    assert made.open_endpoint("ground", Peer(host, port)) is admitted
    assert [alert.detector for alert in made.alerts()] == ([] if admitted else ["peers"])


def test_a_listening_socket_is_limited_to_the_networks_of_its_rules():
    config = configured(PILOT)
    assert peer_ranges(config, "ground") == [("10.1.0.0", 16, 14550, 14560)]
    assert peer_ranges(config, "autopilot") is None
    passing = [rule for rule in engine_rules(config, "ground", None, listening=True) if rule.action == "pass"]
    assert passing[0].name == "firewall.pilot"
    guest = '\n[[firewall.rule]]\nname = "guest"\nfrom = ["0.0.0.0/0"]\nmessages = ["HEARTBEAT"]\n'
    config = configured(PILOT + guest)
    assert ambiguous_rules(config, "ground") == ["pilot", "guest"]
    rules = engine_rules(config, "ground", None, listening=True)
    assert [rule.name for rule in rules if rule.action == "pass"] == ["firewall.pass"]


def test_a_dry_run_raises_alerts_and_drops_nothing():
    made = firewall(with_options("dry_run = true", 'quarantine = "1 min"'))
    assert made.open_endpoint("stranger", Peer("192.0.2.1", 1))
    assert decide(made, command(TAKEOFF))
    assert decide(made, common.HilGps(), name="stranger")
    assert all(rule.dry_run for rule in made.rules("ground") if rule.action == "drop")
    assert made.changed() == []
    assert "would be dropped" in str(made.alerts()[0])


def test_a_rate_is_kept():
    made = firewall('[firewall]\n[[firewall.rule]]\nmessages = ["COMMAND_LONG"]\nrate = 2\n')
    sender = Sender()
    passed = [made.decide("ground", sender.packet(command(512)), 0.1 * step) for step in range(20)]
    assert sum(passed) == 5  # two at once, and two a second
    alerts = made.alerts()
    assert [alert.text for alert in alerts] == ["COMMAND_LONG dropped over its rate"]
    assert made.counts["firewall.rule 1"] == 15


def test_a_refused_source_is_quarantined_and_released():
    made = firewall(with_options("quarantine = 30").replace('"COMMAND_LONG"', '"HIL_GPS"'))
    assert not decide(made, common.HilGps())
    assert made.changed() == ["ground"]
    first = made.rules("ground")[0]
    assert (first.action, first.systems, first.components) == ("drop", frozenset({255}), frozenset({190}))
    made.handle_timeout(29.0)
    assert made.changed() == []
    made.handle_timeout(30.0)
    assert made.changed() == ["ground"]
    assert made.rules("ground")[0].action == "inspect"


def test_an_endpoint_that_is_no_longer_admitted_does_not_get_its_rules_back():
    made = firewall(with_options("quarantine = 30").replace('"COMMAND_LONG"', '"HIL_GPS"'))
    assert not decide(made, common.HilGps())
    closed = RuleSet(default_incoming="drop")
    assert not made.open_endpoint("ground", Peer("10.1.2.3", 14550), own=closed)
    made.handle_timeout(30.0)
    assert made.changed() == []
    assert not decide(made, ground_heartbeat(), now=31.0)


class Broken(Detector):
    name = "broken"
    messages = message_ids(common.CommandLong)

    def inspect(self, origin, packet, now):
        raise KeyError(origin)

    def measure(self, origin, traffic, now):
        raise KeyError(origin)


def test_a_detector_that_fails_passes_nothing_and_stops_nothing(caplog):
    made = Firewall(replace(configured(PILOT), detectors=(Broken(),)))
    made.open_endpoint("ground", Peer("10.1.2.3", 14550))
    assert not decide(made, command(ARM, 1))
    assert decide(made, ground_heartbeat())
    made.measure("ground", Traffic(1, 0), 1.0)
    (alert,) = made.alerts()
    assert (alert.detector, alert.text) == ("broken", "the detector failed, see the log")
    assert "KeyError" in caplog.text


def test_a_command_that_the_dialect_lacks_is_a_message_like_any_other():
    packet = Packet(Sender().packet(command(TAKEOFF)).raw, minimal)
    rules = (
        Rule("drop", commands=frozenset({TAKEOFF})),
        Rule("pass", messages=frozenset({packet.message_id})),
    )
    assert deciding_rule(rules, packet) == (rules[1], [])


def test_a_flooding_endpoint_is_quarantined():
    made = firewall(with_options("quarantine = 30"))
    for second in range(3):
        made.measure("ground", Traffic(packets=second * 100_000, bad_bytes=0), float(second))
    (alert,) = made.alerts()
    assert (alert.detector, alert.source) == ("floods", None)
    assert made.rules("ground")[0].systems == frozenset()


PILOT_AT, STRANGER = Remote("10.1.2.3", 14550), Remote("10.1.2.9", 14550)
OPEN = '[firewall]\ndefault = "allow"\nquarantine = 30\n'


def listening() -> Firewall:
    """A firewall with one listening UDP socket."""
    made = Firewall(configured(OPEN))
    made.open_endpoint("ground", listening=True)
    return made


def test_a_stranger_with_the_ids_of_the_pilot_has_only_its_own_address_cut_off():
    made, pilot, stranger = listening(), Sender(), Sender()
    bad = stranger.packet(common.SerialControl(count=200))
    assert not made.decide("ground", bad, 0.0, peer=STRANGER)
    assert made.blocked("ground") == [STRANGER]
    assert made.changed() == ["ground"]
    assert not any(rule.name.endswith("quarantine") for rule in made.rules("ground"))
    assert made.decide("ground", pilot.packet(command(ARM, 1)), 0.1, peer=PILOT_AT)
    made.handle_timeout(30.0)
    assert made.blocked("ground") == []


def test_a_verified_sender_is_cut_off_by_its_ids():
    made = listening()
    assert not made.decide(
        "ground", Sender().packet(common.SerialControl(count=200)), 0.0, peer=PILOT_AT, verified=True
    )
    assert made.blocked("ground") == []
    assert made.rules("ground")[0].systems == {255}


@pytest.mark.parametrize("peer", [PILOT_AT, None])
def test_an_unsigned_packet_causes_no_quarantine_where_signatures_are_verified(peer):
    """It can have the address of the pilot, which any program can invent, and the ids of the pilot."""
    made = Firewall(configured(OPEN))
    made.open_endpoint("ground", listening=peer is not None, verifies=True)
    bad = Sender().packet(common.SerialControl(count=200))
    assert not made.decide("ground", bad, 0.0, peer=peer)
    assert made.blocked("ground") == []
    assert not any(rule.name.endswith("quarantine") for rule in made.rules("ground"))
    assert not made.decide("ground", bad, 0.0, peer=peer, verified=True)
    assert made.rules("ground")[0].systems == {255}


def test_invented_addresses_and_ids_cut_off_nothing_else():
    made = listening()
    for port in range(1, 3000):
        sender = Sender(port % 250 + 1, 1)
        bad = sender.packet(common.SerialControl(count=200))
        assert not made.decide("ground", bad, 0.0, peer=Remote("10.9.9.9", port))
    assert len(made.blocked("ground")) <= 1024
    assert made.decide("ground", Sender().packet(command(ARM, 1)), 0.1, peer=PILOT_AT)


def test_a_flood_cuts_off_its_peer_and_never_a_listening_socket():
    made = listening()
    for second in range(3):
        made.measure("ground", Traffic(second * 100_000, second * 1_000_000), float(second))
        made.measure("ground", Traffic(second * 20_000, 0), float(second), peer=STRANGER)
        made.measure("ground", Traffic(second * 10, 0), float(second), peer=PILOT_AT)
    assert made.counts["floods"] > 2
    assert made.blocked("ground") == [STRANGER]
    assert not any(rule.name.endswith("quarantine") for rule in made.rules("ground"))


def test_quarantines_of_peers_outlive_a_changed_firewall():
    made = listening()
    made.decide("ground", Sender().packet(common.SerialControl(count=200)), 0.0, peer=STRANGER)
    changed = Firewall(configured(OPEN.replace("30", "60") + "statustext = true\n"))
    changed.inherit(made)
    changed.open_endpoint("ground", listening=True)
    assert changed.blocked("ground") == [STRANGER]


def test_detectors_know_the_messages_of_a_custom_dialect(tmp_path):
    official = resources.files("mavstack.dialects").joinpath("definitions/minimal.xml").read_text("utf-8")
    extension = '<extensions/><field type="uint8_t" name="own">A field.</field></message>'
    before, after = official.split('name="HEARTBEAT"', 1)
    changed = after.replace("</message>", extension, 1)
    (tmp_path / "own.xml").write_text(f'{before}name="HEARTBEAT"{changed}')
    own = Dialect.from_xml(str(tmp_path / "own.xml"))
    made = Firewall(configured('[firewall]\ndefault = "allow"\n'))
    made.open_endpoint("cable")
    made.open_endpoint("radio")
    packets = [Packet(Sender(1, 1).packet(heartbeat()).raw, own) for _ in range(2)]
    assert made.decide("cable", packets[0], 0.0)
    assert not made.decide("radio", packets[1], 0.5)


def test_alerts_are_limited_counted_and_texts_for_pilots():
    made = firewall()
    for step in range(25):
        decide(made, command(TAKEOFF), now=0.5 * step)
    first, second = made.alerts()
    assert (first.count, second.count) == (1, 20)
    assert made.counts["firewall.no takeoff"] == 25
    text = first.statustext()
    assert text.severity == common.MavSeverity.ALERT
    assert text.text.startswith("Firewall firewall.no takeoff: ground")


def test_ids_of_the_pool_belong_to_credentials():
    made = Firewall(
        configured('[firewall]\ndefault = "allow"\n[firewall.ids]\npool = "200-201"\n'), {"ann": 201}
    )
    for name in ("ann", "bob"):
        assert made.open_endpoint(name, credential=name)
    made.open_endpoint("stranger")
    assert made.ids.ids == {"ann": 201, "bob": 200}
    cases = [
        ("ann", 201, True),
        ("ann", 200, False),
        ("bob", 200, True),
        ("stranger", 200, False),
        ("bob", 7, True),
    ]
    for name, system, passes in cases:
        assert decide(made, ground_heartbeat(), source=(system, 190), name=name) is passes, (name, system)
    assert "id 200 is not its own; this station has id 201" in [alert.text for alert in made.alerts()]
    assert not made.open_endpoint("carl", credential="carl")
    (full,) = made.alerts()
    assert (full.detector, full.text) == ("ids", "all 2 system ids of the pool are assigned: enlarge it")
    made.ids.release("bob")
    assert made.ids.assign("carl") == 200


@pytest.mark.parametrize(
    ("line", "problem"),
    [
        ('default = "block"', "must be one of deny, allow"),
        ('detectors = ["nosuch"]', "there is no detector 'nosuch'"),
        ("quarantine = true", "must be a time"),
        ("[firewall.detector.floods]\nmax_packet = 1", "did you mean max_packets?"),
        ("[firewall.detector.nosuch]\na = 1", "is unknown"),
        ('[firewall.ids]\npool = "0-300"', "a range of system ids"),
        ('[firewall.detector.behaviour]\noperators = ["255"]', "is not SYSTEM/COMPONENT"),
        ('[[firewall.rule]]\nfrom = ["10.0.0.1/8"]', "is not a network"),
        ('[[firewall.rule]]\nports = "9-1"', "must be a port or a range"),
        ('[[firewall.rule]]\nmesages = ["HEARTBEAT"]', "did you mean messages?"),
        ('[[firewall.rule]]\nmessages = ["HARTBEAT"]', "did you mean HEARTBEAT?"),
        ('[[firewall.rule]]\naction = "deny"\nrate = 2', "belongs to a rule that allows"),
    ],
)
def test_an_error_names_file_and_line(line, problem):
    with pytest.raises(RouterConfigError, match=r"router.toml:[234]: ") as error:
        configured(f"[firewall]\n{line}\n")
    assert problem in str(error.value)


@given(st.data())
def test_a_filter_and_the_rules_pass_a_packet_only_together(data):
    ids = st.frozensets(st.integers(1, 3), max_size=2)
    actions = st.sampled_from(["pass", "drop"])
    one = st.builds(Rule, actions, messages=st.frozensets(st.sampled_from([0, 76])), systems=ids)
    rules = (*data.draw(st.lists(one, max_size=3)), Rule(data.draw(actions)))
    own = RuleSet(tuple(data.draw(st.lists(one, max_size=3))), default_incoming=data.draw(actions))
    message = data.draw(st.sampled_from([heartbeat(), command(ARM)]))
    packet = Sender(data.draw(st.integers(1, 4)), 1).packet(message)

    def passes(some) -> bool:
        return deciding_rule(some, packet)[0].action == "pass"

    own_passes = passes((*own.incoming, Rule(own.default_incoming)))
    assert passes(with_filter(rules, own)) == (passes(rules) and own_passes)

"""A rule set learned from a flight: it allows that flight, and nothing else."""

from __future__ import annotations

from mavstack.dialects import common
from mavstack.router.config import Table
from mavstack.router.config.names import Names
from mavstack.router.firewall import Firewall, read_firewall
from mavstack.router.firewall.learn import MAX_SENDERS, RuleLearner
from tests.router.firewall.packets import Sender, command, ground_heartbeat, heartbeat


def firewall(text: str) -> Firewall:
    table = Table.parse(text.replace("dry_run = true", ""), "rules.toml").table("firewall")
    made = Firewall(read_firewall(table, Names("common")))
    made.open_endpoint("any")
    return made


def test_the_flight_passes_and_the_rest_does_not():
    ground, vehicle = Sender(255, 190), Sender(1, 1)
    flight = [ground.packet(each) for each in (ground_heartbeat(), command(400, 1), command(31234))]
    flight += [vehicle.packet(each) for each in (heartbeat(), common.Attitude(), common.GlobalPositionInt())]
    learner = RuleLearner()
    learner.add(flight)
    text = learner.toml("flight.tlog")
    assert 'commands = [31234, "COMPONENT_ARM_DISARM"]' in text
    assert 'messages = ["ATTITUDE", "GLOBAL_POSITION_INT", "HEARTBEAT"]' in text
    made = firewall(text)
    assert all(made.decide("any", packet, 0.0) for packet in flight)
    others = [ground.packet(command(22)), ground.packet(common.Attitude()), Sender(2, 1).packet(heartbeat())]
    assert not any(made.decide("any", packet, 0.0) for packet in others)


def test_it_is_a_dry_run_at_first_and_bounded():
    learner = RuleLearner()
    learner.add(
        Sender(system, component).packet(heartbeat()) for system in range(1, 200) for component in (1, 2)
    )
    text = learner.toml("noise.tlog")
    assert "dry_run = true" in text
    assert text.count("[[firewall.rule]]") == MAX_SENDERS

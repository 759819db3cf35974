"""The typed face of the engine, over queue endpoints and real sockets."""

from __future__ import annotations

import select
import socket
from contextlib import ExitStack
from time import time

import pytest

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError, InvalidStateError
from mavstack.router import RouterEngine, Rule, RuleSet
from mavstack.security import SigningKey
from mavstack.wire import Encoder, Parser

ARM = common.MavCmd.COMPONENT_ARM_DISARM
KEY = SigningKey(bytes(range(32)))


@pytest.fixture
def engine():
    with RouterEngine(common) as engine:
        yield engine


def wait_for_event(engine, kind):
    """Return the first event of a kind; fail after ten seconds without any event."""
    while select.select([engine.fileno()], [], [], 10)[0]:
        for event in engine.events():
            if event[0] == kind:
                return event
    raise AssertionError(f"no event {kind}")


def heartbeat(encoder):
    return encoder.encode(common.Heartbeat(type=common.MavType.QUADROTOR), time())


def arm(encoder):
    return encoder.encode(common.CommandLong(target_system=1, target_component=1, command=ARM))


def open_socket(stack):
    opened = stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
    opened.bind(("127.0.0.1", 0))
    opened.settimeout(10)
    return opened


def test_sockets_are_joined_and_statistics_name_them(engine):
    with ExitStack() as stack:
        listener, vehicle, out, ground = (open_socket(stack) for _ in range(4))
        engine.add_udp(listener.fileno(), name="ground")
        engine.add_udp(out.fileno(), name="vehicle", peer=vehicle.getsockname())
        engine.statistics()  # both are open
        ground.sendto(hello := heartbeat(Encoder(255, 190)), listener.getsockname())
        assert vehicle.recv(2048) == hello
        vehicle.sendto(first := heartbeat(Encoder(1, 1)), out.getsockname())
        vehicle.sendto(arm(Encoder(255, 190)), out.getsockname())  # for a system on its own link
        vehicle.sendto(second := heartbeat(Encoder(1, 2)), out.getsockname())
        assert (ground.recv(2048), ground.recv(2048)) == (first, second)
        assert wait_for_event(engine, "peer") == ("peer", 0, ground.getsockname())
        statistics = engine.statistics()
    assert [each.name for each in statistics.endpoints.values()] == ["ground", "vehicle"]
    counted = statistics.endpoints[1]
    assert (counted.received, counted.messages[0]) == (3, (2, 1))
    assert counted.sources[1, 1].received == 1
    routes = {(route.system, route.component): route.endpoints for route in statistics.routes}
    assert routes == {(1, 1): (1,), (1, 2): (1,), (255, 190): (0,)}


def test_rules_drop_and_let_the_program_decide(engine):
    ground, vehicle = engine.add_queue(name="ground"), engine.add_queue(name="vehicle")
    inspect = Rule("inspect", commands=frozenset({ARM}), name="arming")
    quiet = Rule("drop", messages=frozenset({common.SystemTime.__mavlink_row__[0]}), name="no time")
    engine.set_rules(ground, RuleSet(incoming=(inspect,), outgoing=(quiet,)))
    engine.push(vehicle, heartbeat(vehicle_encoder := Encoder(1, 1)))
    engine.push(vehicle, vehicle_encoder.encode(common.SystemTime()))
    assert wait_for_event(engine, "rule")[1:] == (ground, (1, 1, 2), "no time", True, False)
    engine.push(ground, command := arm(Encoder(255, 190)))
    _, token, endpoint, packet, *_ = wait_for_event(engine, "inspect")
    assert (endpoint, packet) == (ground, command)
    engine.decide(token, True)
    wait_for_event(engine, "readable")
    assert engine.pull(vehicle) == [command]
    counted = engine.statistics().endpoints[ground]
    assert counted.dropped == {"rule_out": 1}
    assert counted.incoming_rules[0].matched == 1


def test_a_monitor_gets_packets_whatever_their_target(engine):
    ground, vehicle = engine.add_queue(name="ground"), engine.add_queue(name="vehicle")
    monitor = engine.add_queue(name="monitor", monitor=True)
    engine.push(vehicle, hello := heartbeat(Encoder(1, 1)))
    engine.statistics()
    engine.push(ground, command := arm(Encoder(255, 190)))
    engine.push(monitor, heartbeat(Encoder(7, 1)))
    engine.statistics()
    counted = engine.statistics()
    assert (engine.pull(monitor), engine.pull(vehicle)) == ([hello, command], [command])
    assert counted.endpoints[monitor].dropped == {"listen_only": 1}
    assert {route.system for route in counted.routes} == {1, 255}
    engine.set_monitor(monitor, False)
    engine.push(monitor, heartbeat(Encoder(7, 1)))
    engine.statistics()
    assert 7 in {route.system for route in engine.statistics().routes}


def test_nothing_passes_before_the_start(engine):
    ground = engine.add_queue(name="ground", start=False)
    vehicle = engine.add_queue(name="vehicle")
    assert engine.push(ground, arm(Encoder(255, 190)))
    engine.push(vehicle, heartbeat(Encoder(1, 1)))
    engine.statistics()
    assert engine.statistics().endpoints[ground].received == 0
    engine.set_rules(ground, RuleSet(default_incoming="drop"))
    engine.start(ground)
    engine.statistics()
    assert engine.statistics().endpoints[ground].dropped == {"rule_in": 1}
    assert (engine.pull(ground), engine.pull(vehicle)) == ([], [])


def test_a_full_inbox_refuses_and_a_removed_endpoint_is_routed_first(engine):
    waiting = engine.add_queue(name="waiting", start=False)
    assert [engine.push(waiting, bytes(3 << 20)) for _ in range(2)] == [True, False]
    left, right = engine.add_queue(name="left"), engine.add_queue(name="right")
    engine.push(left, hello := heartbeat(Encoder(1, 1)))
    engine.remove(left)
    engine.statistics()
    assert engine.pull(right) == [hello]


def test_a_gateway_verifies_strips_and_signs(engine):
    field, base, other = (engine.add_queue(name=name) for name in ("field", "base", "other"))
    engine.set_signing(field, incoming=KEY.signing())
    engine.set_signing(other, outgoing=KEY.signing(link_id=7))
    engine.push(field, heartbeat(Encoder(1, 1)))
    assert wait_for_event(engine, "refused")[1:] == (field, (1, 1, 0), "unsigned")
    engine.push(field, signed := heartbeat(Encoder(1, 1, signing=KEY.signing())))
    wait_for_event(engine, "readable")
    engine.statistics()  # the turn has ended
    (stripped,) = engine.pull(base)
    assert stripped == heartbeat(Encoder(1, 1))
    (resigned,) = engine.pull(other)
    (packet,) = Parser(common, signing=KEY.signing()).feed(resigned)
    assert packet.link_id == 7
    assert len(resigned) == len(signed)


def test_misuse_is_refused(engine):
    with socket.socket() as stream:
        number = engine.add_stream(stream.fileno(), name="stream")
    for call in (lambda: engine.push(number, b""), lambda: engine.pull(number)):
        with pytest.raises(InvalidArgumentError, match="endpoint stream is not a queue"):
            call()
    with pytest.raises(InvalidArgumentError, match="endpoint 99 is not open"):
        engine.push(99, b"")
    with pytest.raises(InvalidArgumentError, match="is not an IP address"):
        engine.add_udp(0, name="udp", peer=("example", 1))
    with pytest.raises(InvalidArgumentError, match="framing must be"):
        engine.add_stream(0, name="stream", framing="cobs")
    with pytest.raises(InvalidArgumentError, match="window must be"):
        RouterEngine(common, duplicate_window=-1.0)
    with pytest.raises(OSError, match="Bad file descriptor"):
        engine.add_stream(9999, name="stream")
    engine.close()
    with pytest.raises(InvalidStateError, match="closed"):
        engine.statistics()
    with pytest.raises(InvalidStateError, match="closed"):
        engine.add_queue(name="late")

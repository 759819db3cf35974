"""Discovery: components are found, lost, returned and rebooted."""

from __future__ import annotations

from itertools import count

from mavstack.dialects import common
from mavstack.services import Address
from mavstack.services.heartbeat import (
    ComponentFound,
    ComponentLost,
    ComponentRebooted,
    ComponentReturned,
    Discovery,
    HeartbeatSender,
)
from mavstack.wire import Packet, encode
from tests.services.network import GROUND, START, VEHICLE, Network


def packet(message, source: Address = VEHICLE) -> Packet:
    return Packet(encode(message, system=source.system, component=source.component), common)


HEARTBEAT = common.Heartbeat(type=common.MavType.QUADROTOR, autopilot=common.MavAutopilot.ARDUPILOTMEGA)


def kinds(service) -> list[type]:
    return [type(event) for event in service.events()]


def test_a_component_is_found_lost_and_back() -> None:
    discovery = Discovery(GROUND)
    discovery.receive(packet(HEARTBEAT), START)
    discovery.receive(packet(HEARTBEAT), START + 1)
    assert kinds(discovery) == [ComponentFound]
    assert discovery.next_timeout() <= START + 6
    discovery.handle_timeout(START + 5.9)
    assert kinds(discovery) == []
    assert discovery.next_timeout() == START + 6
    discovery.handle_timeout(START + 6)
    assert kinds(discovery) == [ComponentLost]
    assert not discovery.components[VEHICLE].alive
    assert discovery.next_timeout() is None
    discovery.receive(packet(HEARTBEAT), START + 60)
    assert kinds(discovery) == [ComponentReturned]
    assert discovery.components[VEHICLE].alive


def test_type_and_not_component_id_marks_an_autopilot() -> None:
    discovery = Discovery(GROUND)
    gimbal = common.Heartbeat(type=common.MavType.GIMBAL, autopilot=common.MavAutopilot.INVALID)
    discovery.receive(packet(gimbal, Address(1, 1)), START)
    discovery.receive(packet(HEARTBEAT, Address(1, 77)), START)
    assert not discovery.components[1, 1].is_autopilot  # type: ignore[index]
    assert discovery.components[1, 77].is_autopilot  # type: ignore[index]


def test_other_messages_count_as_signs_of_life() -> None:
    discovery = Discovery(GROUND)
    discovery.receive(packet(common.Attitude(time_boot_ms=5)), START)
    assert not discovery.components  # no HEARTBEAT came from it
    discovery.receive(packet(HEARTBEAT), START)
    for second in range(1, 20):
        discovery.receive(packet(common.Attitude(time_boot_ms=second * 1000)), START + second)
        discovery.handle_timeout(START + second)
    assert kinds(discovery) == [ComponentFound]


def boot_times(*milliseconds: int, every: float = 0.1) -> list[type]:
    discovery = Discovery(GROUND)
    discovery.receive(packet(HEARTBEAT), START)
    for number, value in enumerate(milliseconds):
        discovery.receive(packet(common.Attitude(time_boot_ms=value)), START + number * every)
    return kinds(discovery)[1:]


def test_a_falling_boot_time_is_a_reboot() -> None:
    assert boot_times(50_000, 52_000, 300, 2_300, 4_300, every=2.0) == [ComponentRebooted]


def test_an_reordered_message_is_no_reboot() -> None:
    assert boot_times(50_000, 50_100, 49_000, 50_200, 48_500, 50_300) == []


def test_high_latency_sources_need_no_heartbeat() -> None:
    discovery = Discovery(GROUND)
    summary = common.HighLatency2(type=common.MavType.FIXED_WING, autopilot=common.MavAutopilot.PX4)
    discovery.receive(packet(summary), START)
    assert discovery.components[VEHICLE].is_autopilot
    discovery.handle_timeout(START + 149)
    assert kinds(discovery) == [ComponentFound]
    discovery.handle_timeout(START + 150)
    assert kinds(discovery) == [ComponentLost]


def test_address_0_is_ignored_and_memory_is_bounded() -> None:
    channels = count()
    discovery = Discovery(GROUND, channel_name=lambda: str(next(channels)))
    discovery.receive(packet(HEARTBEAT, Address(0, 1)), START)
    discovery.receive(packet(HEARTBEAT, Address(1, 0)), START)
    assert not discovery.components
    for system in range(1, 256):
        for component in range(1, 30):
            discovery.receive(packet(HEARTBEAT, Address(system, component)), START)
    assert 4096 - 256 <= len(discovery.components) <= 4096


def test_heartbeats_keep_their_rate_after_a_stall() -> None:
    sender = HeartbeatSender(VEHICLE, common.MavType.ROCKET)
    times = []
    now = START
    for late in (0.0, 0.01, 0.0, 3.7, 0.0, 0.0):
        now = max(sender.next_timeout() or 0.0, START) + late
        sender.handle_timeout(now)
        times += [round(now - START, 2) for _ in sender.messages_to_send(now)]
    assert times == [0.0, 1.01, 2.0, 6.7, 7.7, 8.7]


def test_loss_and_return_over_a_network() -> None:
    network = Network(1)

    def setup(engine) -> None:
        engine.add(HeartbeatSender(VEHICLE, common.MavType.QUADROTOR, common.MavAutopilot.PX4))

    vehicle = network.node(VEHICLE, setup)
    ground = network.node(GROUND, lambda engine: engine.add(Discovery(GROUND)))
    pipes = network.connect(ground, vehicle)
    network.run(timeout=10)
    assert len(ground.events_of(ComponentFound)) == 1
    for pipe in pipes:
        pipe.cut = True
    network.run(timeout=10)
    assert len(ground.events_of(ComponentLost)) == 1
    for pipe in pipes:
        pipe.cut = False
    network.run(timeout=2)
    assert len(ground.events_of(ComponentReturned)) == 1


def test_the_identifier_of_a_firmware_stays_with_its_heartbeats() -> None:
    discovery = Discovery(GROUND)
    version = packet(common.AutopilotVersion(flight_custom_version=b"BTFL\0\0\0\0"))
    discovery.receive(version, START)
    assert discovery.components == {}
    for message in (packet(HEARTBEAT), version, packet(HEARTBEAT)):
        discovery.receive(message, START)
    assert discovery.components[VEHICLE].identifier == "BTFL"

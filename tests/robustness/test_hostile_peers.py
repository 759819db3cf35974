"""Every client and every server of one component, against a peer that sends random packets.

Nothing raises, every operation ends, memory stays bounded, and no timer is due endlessly.
"""

from __future__ import annotations

from random import Random
from typing import TYPE_CHECKING

import pytest

from mavstack.dialects import common
from mavstack.errors import RemoteError
from mavstack.node.engine import Engine
from mavstack.node.service_timers import MAX_OUTDATED_TIMERS
from mavstack.security import SigningKey
from mavstack.services import Address, Service
from mavstack.services.command import Command, CommandClient, CommandServer
from mavstack.services.extended_parameters import ExtendedParameterClient, ExtendedParameterServer
from mavstack.services.ftp import FtpClient, FtpServer, MemoryStore
from mavstack.services.heartbeat import Discovery, HeartbeatSender
from mavstack.services.heartbeat.admission import MAX_COMPONENTS
from mavstack.services.log import LogClient, LogEntry, LogServer
from mavstack.services.manual_control import ManualControlReceiver
from mavstack.services.message_request import (
    GetMessageInterval,
    Interval,
    MessageServer,
    RequestMessage,
    SetMessageInterval,
)
from mavstack.services.mission import MissionClient, MissionItem, MissionServer, Plan
from mavstack.services.modes import (
    AvailableMode,
    ListModes,
    ModeMonitor,
    ModeServer,
    SetMode,
    SetStandardMode,
)
from mavstack.services.parameters import ParameterClient, ParameterServer
from mavstack.services.ping import PingClient, PingServer
from mavstack.services.serial_control import ShellClient, ShellServer
from mavstack.services.setpoints import SetpointReceiver
from mavstack.services.signing_setup import SigningSetupClient, SigningSetupServer
from mavstack.services.statustext import StatustextReceiver, StatustextSender
from mavstack.services.system_time import SystemTimeBroadcaster, SystemTimeObserver
from mavstack.services.timesync import TimesyncClient, TimesyncServer
from mavstack.services.version import RequestAutopilotVersion, RequestProtocolVersion
from tests.robustness.random_peer import RandomPeer
from tests.services.network import GROUND, START, VEHICLE

if TYPE_CHECKING:
    from mavstack.services import Operation
    from tests.seeds import Seeds

#: Seconds within which all operations end; a log download has the longest timeout.
DEADLINE = 3700.0
PLAN = Plan.of([MissionItem(common.MavCmd.NAV_WAYPOINT, param5=47 + n, param6=8, param7=9) for n in range(3)])
OTHERS = [Address(1, 2), Address(7, 1), GROUND, Address(255, 1), Address(1, 255)]


class Logs:
    def logs(self) -> list[LogEntry]:
        return [LogEntry(1, 5, 300), LogEntry(2, 6, 90)]

    def read(self, number: int, offset: int, count: int, /) -> bytes:
        return bytes(count)

    def erase(self) -> None:
        """Keep the logs."""


def add_servers(engine: Engine) -> list[Service]:
    local = engine.local
    commands = CommandServer(local)
    commands.support(common.MavCmd.DO_SET_SERVO, lambda _: common.MavResult.ACCEPTED)
    commands.support(common.MavCmd.NAV_TAKEOFF, lambda _: None)
    messages = MessageServer(local, commands)
    messages.provide(common.Attitude, lambda now: common.Attitude(), interval=1.0, now=START)
    modes = ModeServer(local, [AvailableMode(0, "one"), AvailableMode(4, "two")], 0)
    modes.register(commands)
    parameters, extended = ParameterServer(local), ExtendedParameterServer(local)
    for number in range(9):
        parameters.add(f"P{number}", number)
        extended.add(f"E{number}", number)
    mission = MissionServer(local)
    mission.replace(PLAN)
    servers = [
        *(commands, messages, modes, parameters, extended, mission),
        *(LogServer(local, Logs()), FtpServer(local, MemoryStore({"a": bytes(999)}))),
        *(PingServer(local), TimesyncServer(local), ShellServer(local), SetpointReceiver(local)),
        *(ManualControlReceiver(local), SystemTimeObserver(local), StatustextReceiver(local)),
        *(
            Discovery(local),
            HeartbeatSender(local),
            StatustextSender(local),
            SystemTimeBroadcaster(local, START),
        ),
        SigningSetupServer(local, may_set=lambda _: None),
    ]
    return [engine.add(server) for server in servers]


def start_all_operations(engine: Engine, now: float, target: Address = VEHICLE) -> list[Operation]:
    """Start one operation of each kind."""
    add, local = engine.add, engine.local
    commands = add(CommandClient(local, target))
    parameters, extended = add(ParameterClient(local, target)), add(ExtendedParameterClient(local, target))
    mission, logs, files = (add(kind(local, target)) for kind in (MissionClient, LogClient, FtpClient))
    ping, signing = add(PingClient(local, target)), add(SigningSetupClient(local, target))
    for listener in (TimesyncClient(local, target), ModeMonitor(local, target), ShellClient(local, target)):
        add(listener)
        if isinstance(listener, ShellClient):
            listener.open(now)
    operations = [
        *(commands.command(Command(command), now) for command in (16, 20, 183)),
        *(
            commands.begin(operation, now)
            for operation in (
                RequestMessage(common.Attitude),
                RequestAutopilotVersion(),
                RequestProtocolVersion(),
                GetMessageInterval(common.Attitude),
                SetMessageInterval(common.Attitude, Interval(1000)),
                SetMode("AUTO"),
                SetStandardMode(3),
                ListModes(),
            )
        ),
        parameters.download(now),
        parameters.get("P1", now),
        parameters.set("P2", 3, now, kind=6),
        extended.download(now),
        extended.set("E1", 3, now, kind=6),
        *(mission.upload(PLAN, now), mission.download(now)),  # type: ignore[call-arg]
        *(mission.clear(now), mission.set_current(2, now)),
        *(logs.list_logs(now), logs.download(1, now), logs.erase(now)),
        *(files.download("a", now), files.list_directory("/", now), files.upload("b", bytes(999), now)),
        ping.ping(now),
        signing.install(SigningKey.generate(), now),
    ]
    for client in (commands, parameters, extended, mission, logs, files, ping, signing):
        engine.touch(client)
    return operations


def ids_of(engine: Engine) -> list[int]:
    return sorted(set().union(*(service.handles for service in engine._services)))


class EngineHarness:
    """An engine, a random peer and a clock."""

    def __init__(self, seed: int) -> None:
        self.random = Random(seed)
        self.engine = Engine(GROUND, common)
        self.channel = self.engine.open_channel("wire")
        self.now = START
        self.peer = RandomPeer(self.random, GROUND)
        self.sent = 0

    def receive(self, data: bytes) -> None:
        self.engine.receive(self.channel, data, self.now)

    def settle(self) -> list[bytes]:
        data = [chunk for _, chunk in self.engine.data_to_send(self.now)]
        self.sent += len(data)
        self.engine.events()
        return data

    def wait(self, seconds: float) -> None:
        """Advance the clock, as a driver does: each timer when it is due."""
        end, repeats = self.now + seconds, 0
        while (due := self.engine.next_timeout()) is not None and due <= end:
            repeats = 0 if due > self.now else repeats + 1
            assert repeats < 200, "a timer is due endlessly"
            self.now = max(self.now, due)
            self.engine.handle_timeout(self.now)
            self.settle()
        self.now = end


def scenario(seed: int) -> None:
    harness = EngineHarness(seed)
    random, engine = harness.random, harness.engine
    servers = add_servers(engine)
    operations = start_all_operations(engine, harness.now)
    for _ in range(150):
        ids = ids_of(engine)
        for _ in range(random.choice([1, 1, 5])):
            source = VEHICLE if random.random() < 0.7 else random.choice(OTHERS)
            harness.receive(harness.peer.random_packet(random.choice(ids), source))
        sent = harness.settle()
        assert len(sent) < 1000
        for echo in sent[: random.choice([0, 0, 3])]:
            harness.receive(echo)
        if random.random() < 0.1:  # called early, and late
            engine.handle_timeout(harness.now)
        harness.wait(random.choice([0.0, 0.0, 0.01, 0.3, 2.0]))
    for server in servers:  # servers publish their states endlessly
        engine.remove(server)
    harness.now += random.choice([0.0, 1e9])
    harness.wait(DEADLINE)
    for operation in operations:
        assert operation.done, operation.description
        assert operation.error is None or isinstance(operation.error, RemoteError)
        harness.receive(harness.peer.random_packet(random.choice(ids_of(engine)), VEHICLE))
    harness.settle()


@pytest.mark.flight
def test_every_service_against_a_random_peer(seeds: Seeds) -> None:
    seeds.check(scenario)


@pytest.mark.parametrize("answer", ["entries", "counts"])
def test_a_parameter_list_that_changes_endlessly_fails(answer: str) -> None:
    harness = EngineHarness(1)
    client = harness.engine.add(ParameterClient(GROUND, VEHICLE))
    operation = client.download(harness.now)
    for number in range(100_000):
        if operation.done:
            break
        if answer == "counts":
            index, count = (15, 20) if number % 2 else (0, 12)
        else:
            index, count = number % 30_000, min(number + 2, 32_000)
        message = common.ParamValue(param_id=f"P{index}", param_index=index, param_count=count)
        harness.receive(harness.peer.packet(message, VEHICLE))
        harness.settle()
        harness.wait(0.01)
    assert operation.done
    assert "kept changing" in str(operation.error)


def test_a_log_list_that_changes_endlessly_fails() -> None:
    harness = EngineHarness(1)
    client = harness.engine.add(LogClient(GROUND, VEHICLE))
    operation = client.list_logs(harness.now)
    for number in range(1000):
        message = common.LogEntry(id=number % 60_000, num_logs=500 + number % 2, last_log_num=60_000)
        harness.receive(harness.peer.packet(message, VEHICLE))
        harness.wait(0.1)
    assert "the list kept changing" in str(operation.error)


def test_a_mission_download_that_restarts_endlessly_fails() -> None:
    harness = EngineHarness(1)
    client = harness.engine.add(MissionClient(GROUND, VEHICLE))
    operation = client.download(harness.now)
    for _ in range(1000):
        for message in (common.MissionCount(count=9), common.MissionItemInt(seq=0)):
            message.target_system, message.target_component = GROUND
            harness.receive(harness.peer.packet(message, VEHICLE))
            harness.settle()
        harness.wait(0.5)
    assert "restarted the transfer endlessly" in str(operation.error)


@pytest.mark.flight
def test_memory_is_bounded_under_a_flood_of_all_addresses() -> None:
    harness = EngineHarness(1)
    services = add_servers(harness.engine)
    discovery = next(service for service in services if isinstance(service, Discovery))
    attack = [
        common.Heartbeat(),
        common.ParamRequestList(),
        common.MissionClearAll(),
        common.Statustext(id=3),
    ]
    attack += [common.Ping(), common.SystemTime(time_boot_ms=9), common.CommandLong(command=183, param1=3)]
    attack += [common.LogRequestList(end=9), common.MissionRequestList(), common.SetAttitudeTarget()]
    for system in range(1, 256):
        message = attack[system % len(attack)]
        harness.receive(
            b"".join(harness.peer.packet(message, Address(system, each)) for each in range(1, 256))
        )
        harness.settle()
        harness.wait(0.001)
    assert len(discovery.components) <= MAX_COMPONENTS
    assert max(deep_lengths(harness.engine, services)) <= MAX_COMPONENTS


def test_the_heap_of_timers_does_not_grow_with_packets() -> None:
    harness = EngineHarness(1)
    receiver = harness.engine.add(SetpointReceiver(GROUND, timeout=1e6))
    for _ in range(5 * MAX_OUTDATED_TIMERS):
        receiver._timeout += 1
        harness.engine.touch(receiver)
        harness.receive(harness.peer.packet(common.SetAttitudeTarget(q=(1, 0, 0, 0)), VEHICLE))
        harness.settle()
    assert len(harness.engine._timers._timers) <= MAX_OUTDATED_TIMERS + 10


def deep_lengths(*roots: object) -> list[int]:
    """Return the lengths of all containers that can be reached through objects of services and node."""
    lengths, seen, rest = [0], set(), list(roots)
    while rest:
        item = rest.pop()
        if id(item) in seen or isinstance(item, type | str | bytes | int | float):
            continue
        seen.add(id(item))
        if isinstance(item, dict):
            rest += [*item.keys(), *item.values()]
        elif hasattr(item, "__len__") and hasattr(item, "__iter__"):
            rest += list(item)
        if hasattr(item, "__len__"):
            lengths.append(len(item))
        if type(item).__module__.startswith("mavstack.services") or type(item).__module__.startswith(
            "mavstack.node"
        ):
            names = list(getattr(item, "__dict__", {})) + [
                name for kind in type(item).__mro__ for name in getattr(kind, "__slots__", ())
            ]
            rest += [getattr(item, name) for name in names if hasattr(item, name)]
    return lengths

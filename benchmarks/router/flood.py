"""The control traffic of two links while a third one floods the router.

`load.c` sends 500,000 packets per second to a UDP port of the engine, for every other link: once each with
system calls of two threads, as far as the machine can, and once 32 together in one system call. A ground
station on a stream sends 100 commands per second to a vehicle on another, and each is acknowledged. Once the
rules of both streams drop the flood; once they get it too, and read slower than it comes, as a radio would:
then their queues are full, and the commands overtake. Measured: the time from a command to its
acknowledgement, and the growth of memory.
"""

from __future__ import annotations

import json
import socket
import subprocess
import threading
from contextlib import ExitStack, suppress
from dataclasses import dataclass
from pathlib import Path
from statistics import quantiles
from time import monotonic, sleep
from typing import TYPE_CHECKING

from mavstack import Encoder, Parser
from mavstack.dialects import common
from mavstack.router import RouterEngine, Rule, RuleSet

if TYPE_CHECKING:
    from mavstack.dialects import Message

RATE, SECONDS, COMMANDS_PER_SECOND = 500_000, 5, 100
#: Bytes that a reader takes at a time and seconds between two reads: less than 4 MB/s; the flood has 20.
READ_SIZE, READ_INTERVAL, RECEIVE_BUFFER = 4096, 0.001, 16_384
FLOOD_MESSAGE = 250
ADDRESS = ("127.0.0.1", 0)


@dataclass(frozen=True, slots=True)
class Result:
    """Delays in milliseconds, and other figures of one run."""

    median: float
    late: float
    worst: float
    answered: int
    sent: int
    flooded: int
    processed: int
    growth: int


class Party(threading.Thread):
    """One end of the control traffic, which reads slowly."""

    def __init__(self, engine: RouterEngine, name: str, rules: RuleSet, address: tuple[int, int]) -> None:
        super().__init__(daemon=True)
        ours, self.stream = socket.socketpair()
        for each in (ours, self.stream):
            each.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, RECEIVE_BUFFER)
        self.encoder = Encoder(*address)
        self.sent_at: dict[int, float] = {}
        self.delays: list[float] = []
        with ours:
            endpoint = engine.add_stream(ours.fileno(), name=name, start=False)
        engine.set_rules(endpoint, rules)
        engine.start(endpoint)
        self.send(common.Heartbeat())

    def send(self, message: Message) -> None:
        """Send a message."""
        self.stream.sendall(self.encoder.encode(message))

    def run(self) -> None:
        """Read until the stream is closed."""
        parser = Parser(common)
        with suppress(OSError):
            while data := self.stream.recv(READ_SIZE):
                for packet in parser.feed(data):
                    self._handle(packet.message)
                sleep(READ_INTERVAL)

    def _handle(self, message: object) -> None:
        match message:
            case common.CommandLong():
                ack = common.CommandAck(
                    command=message.command,
                    result_param2=int(message.param1),
                    target_system=255,
                    target_component=190,
                )
                self.send(ack)
            case common.CommandAck():
                self.delays.append(monotonic() - self.sent_at[message.result_param2])


def report(load: Path) -> None:
    """Measure without and with the flood on the control links, and print a table."""
    drop = RuleSet(outgoing=(Rule("drop", messages=frozenset({FLOOD_MESSAGE})),))
    head = ("median ms", "p99 ms", "worst ms", "answered", "sent/s", "routed/s", "memory kB")
    print(f"{'command to answer in a flood':40}" + "".join(f"{each:>12}" for each in head))
    for name, rules in (("streams drop the flood", drop), ("streams get the flood", RuleSet())):
        for kind, options in (("", ("0", "2")), (", sent together", ("1", "1"))):
            found = measure(load, rules, options)
            answered = f"{found.answered}/{found.sent}"
            flooded, processed = found.flooded / SECONDS, found.processed / SECONDS
            print(f"{name + kind:40}{found.median:12.2f}{found.late:12.2f}{found.worst:12.2f}", end="")
            print(f"{answered:>12}{flooded:12,.0f}{processed:12,.0f}{found.growth:12}", flush=True)


def measure(load: Path, rules: RuleSet, options: tuple[str, str]) -> Result:
    """Run the flood beside the control traffic of two links with these rules.

    Args:
        load: The program of the load.
        rules: The rules of both links.
        options: Whether the datagrams of the flood are sent together, and the number of its threads.
    """
    with RouterEngine(common) as engine, ExitStack() as sockets:
        listener = sockets.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
        listener.bind(ADDRESS)
        flooded = engine.add_udp(listener.fileno(), name="flood")
        vehicle = Party(engine, "vehicle", rules, (1, 1))
        station = Party(engine, "station", rules, (255, 190))
        for party in (vehicle, station):
            sockets.enter_context(party.stream)
            party.start()
        before = resident_kilobytes()
        command = [str(load), "flood", str(listener.getsockname()[1]), str(RATE), str(SECONDS), *options]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
            number = send_commands(station)
            output = process.communicate()[0]
        growth = resident_kilobytes() - before
        received = engine.statistics().endpoints[flooded].received
        sleep(1)
    cuts = quantiles(station.delays, n=100) if len(station.delays) > 1 else [float("inf")] * 99
    return Result(
        median=cuts[49] * 1e3,
        late=cuts[98] * 1e3,
        worst=max(station.delays, default=float("inf")) * 1e3,
        answered=len(station.delays),
        sent=number,
        flooded=int(json.loads(output)["sent"]),
        processed=received,
        growth=growth,
    )


def send_commands(station: Party) -> int:
    """Send commands while the flood lasts; return their number."""
    begin = monotonic()
    number = 0
    while monotonic() - begin < SECONDS - 1:
        station.sent_at[number] = monotonic()
        station.send(common.CommandLong(target_system=1, target_component=1, command=512, param1=number))
        number += 1
        sleep(1 / COMMANDS_PER_SECOND)
    return number


def resident_kilobytes() -> int:
    """Return the resident memory of this process."""
    lines = Path("/proc/self/status").read_text("utf-8").splitlines()
    return int(next(line.split()[1] for line in lines if line.startswith("VmRSS")))

"""Vehicles that send to an inspector, in virtual time."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from mavstack.cli.watch.inspector.model import Inspector
from mavstack.cli.watch.inspector.packet_store import StreamKey
from mavstack.cli.watch.observer import Selection
from mavstack.cli.watch.sources import open_sources
from mavstack.cli.watch.trend import FieldPatterns
from mavstack.dialects import Dialect, common
from mavstack.wire import Encoder

if TYPE_CHECKING:
    from mavstack.cli.watch.sources import WatchedSource
    from mavstack.dialects import Message

ALL = Dialect.load("all")
START = 1_700_000_000.0
LINKS = ("udpin://0.0.0.0:14550", "tcp://127.0.0.1:5760")

HEARTBEAT = common.Heartbeat(
    type=common.MavType.QUADROTOR,
    autopilot=common.MavAutopilot.ARDUPILOTMEGA,
    base_mode=129,
    custom_mode=5,
    system_status=common.MavState.ACTIVE,
    mavlink_version=3,
)
ATTITUDE, HEARTBEAT_ID = 30, 0


@dataclass
class Watched:
    """An inspector of one or two links, and the vehicles behind them."""

    links: int = 1
    patterns: str = ""
    now: float = 0.0
    encoders: dict[tuple[str, int], Encoder] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.sources = open_sources(LINKS[: self.links], ALL, Selection())
        for source in self.sources:
            source.observer.open(source.title)
        patterns = FieldPatterns(self.patterns, ALL) if self.patterns else None
        self.inspector = Inspector(self.sources, patterns=patterns)

    def source(self, label: str) -> WatchedSource:
        return next(source for source in self.sources if source.label == label)

    def send(self, *messages: Message, system: int = 1, label: str = "") -> None:
        """Send messages of a vehicle on a link."""
        source = self.source(label)
        encoder = self.encoders.setdefault((label, system), Encoder(system, 1))
        for message in messages:
            time = START + self.now
            packets = source.observer.receive(source.title, encoder.encode(message), self.now, time=time)
            self.inspector.receive(label, packets, time, self.now)

    def lose(self, count: int, system: int = 1, label: str = "") -> None:
        """Lose packets of a vehicle."""
        encoder = self.encoders.setdefault((label, system), Encoder(system, 1))
        encoder.sequence = (encoder.sequence + count) % 256

    def wait(self, seconds: float) -> None:
        self.now += seconds

    def fly(self, count: int = 10, system: int = 1, label: str = "") -> None:
        """Send a heartbeat, then attitudes with a roll of 0.0, 0.1, …, ten per second; take a picture."""
        self.send(HEARTBEAT, system=system, label=label)
        for index in range(count):
            self.wait(0.1)
            self.send(
                common.Attitude(time_boot_ms=100 * index, roll=index / 10, pitch=float("nan")),
                system=system,
                label=label,
            )
        self.inspector.update(self.now)


def stream(message_id: int = ATTITUDE, system: int = 1, label: str = "") -> StreamKey:
    return StreamKey(label, system, 1, message_id)

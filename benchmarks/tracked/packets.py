"""The packets of a simulated PX4 copter at any rate, in their proportions, with boot times that fit."""

from __future__ import annotations

from itertools import cycle, islice
from typing import TYPE_CHECKING, NamedTuple

from benchmarks.telemetry import recording
from mavstack.dialects import Dialect
from mavstack.wire import Encoder, Parser

if TYPE_CHECKING:
    from mavstack.dialects import Message

#: Seconds of the recording that are repeated; a position may move by no more in one step.
EXCERPT = 1.0
#: Messages to subscribe to: twenty that come five times a second, or less often.
SUBSCRIBED = (
    *("GPS_RAW_INT", "VFR_HUD", "HEARTBEAT", "ALTITUDE", "SCALED_PRESSURE", "SYS_STATUS", "PING"),
    *("EXTENDED_SYS_STATE", "MISSION_CURRENT", "SYSTEM_TIME", "ESC_INFO", "ESC_STATUS", "CURRENT_MODE"),
    *("ESTIMATOR_STATUS", "DISTANCE_SENSOR", "BATTERY_STATUS", "HOME_POSITION", "TIME_ESTIMATE_TO_TARGET"),
    *("VIBRATION", "STATUSTEXT"),
)
BOOT_MS = 10_000


class Part(NamedTuple):
    """A part of the time in which packets are sent: seconds, and packets per second."""

    seconds: float
    rate: int


def packets(*parts: Part) -> list[list[bytes]]:
    """Return the packets of each part, one after the other."""
    encoder, messages = Encoder(1, 1), cycle(_messages())
    began, sent = BOOT_MS, list[list[bytes]]()
    for part in parts:
        each = enumerate(islice(messages, int(part.seconds * part.rate)))
        times = ((message, began + 1000 * index // part.rate) for index, message in each)
        sent.append([encoder.encode(_at(message, boot_ms)) for message, boot_ms in times])
        began += int(1000 * part.seconds)
    return sent


def _messages() -> list[Message]:
    parser = Parser(Dialect.load("all"))
    received = (parser.feed(packet.data) for packet in recording.record(EXCERPT))
    return [packet.message for each in received for packet in each if packet.message is not None]


def _at(message: Message, boot_ms: int) -> Message:
    return message.replace(time_boot_ms=boot_ms) if hasattr(message, "time_boot_ms") else message

"""Questions that tell the senders of one address apart, over each channel on which it is heard.

An address that is heard on several channels is asked on each of them for its AUTOPILOT_VERSION, whose unique
id names the board, and for its time (TIMESYNC), which measures the round trip of the channel. The one command
for the version is new, the other one deprecated; they are sent in turn, since firmwares know one or both.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.services.addressing import message_ids
from mavstack.services.service import Outgoing, earliest

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.services.addressing import Address

#: Seconds between two requests for a unique id that is not known.
VERSION_INTERVAL = 1.0
#: The number of requests at this interval.
MAX_REQUESTS = 5
#: Seconds between two requests for a unique id that is known already, or that the vehicle has never sent.
CONFIRMATION_INTERVAL = 6.0
#: Seconds between two measurements of the round trip.
TIME_INTERVAL = 1.0
#: Seconds for which a measured round trip is valid, and for which a request waits for its answer.
MAX_ROUND_TRIP_AGE = 20.0
MAX_OUTSTANDING = 32
MAX_CHANNELS = 8
#: The largest number of addresses that are asked at a time, because addresses can be forged.
MAX_PROBES = 32
_AUTOPILOT_VERSION = next(iter(message_ids(common.AutopilotVersion)))


@dataclass(slots=True)
class _Channel:
    """The questions over one channel."""

    version_due: float
    time_due: float
    requests: int = 0
    outstanding: dict[int, float] = field(default_factory=dict)
    # pairs: time of the answer, round trip
    round_trips: list[tuple[float, float]] = field(default_factory=list)


class SenderProbe:
    """The questions to one address.

    Args:
        address: The address.
    """

    def __init__(self, address: Address) -> None:
        self._address = address
        self._channels: dict[str, _Channel] = {}
        self._links: set[frozenset[str]] = set()

    def set_channels(self, channels: tuple[str, ...], now: float) -> None:
        """Ask over these channels from now on."""
        for channel in self._channels.keys() - set(channels):
            self.remove_channel(channel)
        for channel in channels[:MAX_CHANNELS]:
            self._channels.setdefault(channel, _Channel(now, now))

    def remove_channel(self, channel: str) -> None:
        """Ask over a channel no more. Idempotent."""
        self._channels.pop(channel, None)
        self._links = {link for link in self._links if channel not in link}

    def are_linked(self, channels: tuple[str, ...]) -> bool:
        """Return whether questions over one channel are answered over another one, for all channels."""
        linked = set(channels[:1])
        while joined := {name for link in self._links if link & linked for name in link} - linked:
            linked |= joined
        return linked >= set(channels)

    def answered(self, channel: str, now: float) -> None:
        """Record that a unique id was received on a channel."""
        if (known := self._channels.get(channel)) is not None:
            known.requests = MAX_REQUESTS
            known.version_due = now + CONFIRMATION_INTERVAL

    def time_received(self, message: common.Timesync, now: float, channel: str) -> None:
        """Record an answer; one over another channel than its question shows that both lead to one sender."""
        for name, asked in self._channels.items():
            if name != channel and message.tc1 and message.ts1 in asked.outstanding:
                self._links.add(frozenset((name, channel)))
        known = self._channels.get(channel)
        sent_at = known.outstanding.pop(message.ts1, None) if known is not None and message.tc1 else None
        if known is None or sent_at is None:
            return
        known.round_trips.append((now, now - sent_at))
        known.round_trips = [each for each in known.round_trips if now - each[0] <= MAX_ROUND_TRIP_AGE]

    def round_trip(self, channel: str, now: float, unknown: float) -> float:
        """Return the longest round trip of late over a channel, in seconds; `unknown` if none was measured.

        A question that waits for its answer takes at least as long as it has waited.
        """
        known = self._channels.get(channel)
        if known is None or not known.round_trips:
            return unknown
        waiting = (now - sent_at for sent_at in known.outstanding.values())
        lost_after = max(known.round_trips[-1][1] * 3, TIME_INTERVAL * 3)
        measured = [trip for at, trip in known.round_trips if now - at <= MAX_ROUND_TRIP_AGE]
        return max([*measured, *(age for age in waiting if age <= lost_after)], default=unknown)

    def next_timeout(self) -> float | None:
        """Return when the next question is due."""
        return earliest(*(min(each.version_due, each.time_due) for each in self._channels.values()))

    def questions(self, now: float) -> Iterator[Outgoing]:
        """Yield the questions that are due."""
        for name, channel in self._channels.items():
            if now >= channel.version_due:
                is_urgent = channel.requests < MAX_REQUESTS
                channel.version_due = now + (VERSION_INTERVAL if is_urgent else CONFIRMATION_INTERVAL)
                yield Outgoing(self._version_request(channel.requests), self._address, channel=name)
                channel.requests += 1
            if now >= channel.time_due:
                channel.time_due = now + TIME_INTERVAL
                yield Outgoing(self._time_request(channel, now), self._address, channel=name)

    def _version_request(self, number: int) -> common.CommandLong:
        system, component = self._address
        is_current = number % 2 == 0
        commands = common.MavCmd
        return common.CommandLong(
            target_system=system,
            target_component=component,
            command=commands.REQUEST_MESSAGE if is_current else commands.REQUEST_AUTOPILOT_CAPABILITIES,
            param1=_AUTOPILOT_VERSION if is_current else 1,
        )

    def _time_request(self, channel: _Channel, now: float) -> common.Timesync:
        system, component = self._address
        stamp = round(now * 1e9)
        while any(stamp in each.outstanding for each in self._channels.values()):
            stamp += 1
        channel.outstanding[stamp] = now
        while len(channel.outstanding) > MAX_OUTSTANDING:
            del channel.outstanding[next(iter(channel.outstanding))]
        return common.Timesync(tc1=0, ts1=stamp, target_system=system, target_component=component)


class SenderProbes:
    """The questions of one component to the autopilots whose senders are in doubt.

    Args:
        asks: Whether it may ask at all.
    """

    def __init__(self, asks: bool) -> None:
        self._asks = asks
        self._probes: dict[Address, SenderProbe] = {}

    def update(
        self, address: Address, channels: tuple[str, ...], now: float, *, is_suspect: bool = False
    ) -> None:
        """Ask an address that is heard on several channels, or on a suspect one; ask others no more."""
        if len(channels) < 2 and not is_suspect:
            self._probes.pop(address, None)
        elif self._asks:
            probe = self._probes.get(address)
            if probe is None and len(self._probes) < MAX_PROBES:
                probe = self._probes[address] = SenderProbe(address)
            if probe is not None:
                probe.set_channels(channels, now)

    def remove(self, address: Address) -> None:
        """Forget an address."""
        self._probes.pop(address, None)

    def remove_channel(self, address: Address, channel: str) -> None:
        """Ask an address over a channel no more."""
        if (probe := self._probes.get(address)) is not None:
            probe.remove_channel(channel)

    def answered(self, address: Address, channel: str, now: float) -> None:
        """Record that the unique id of an address was received on a channel."""
        if (probe := self._probes.get(address)) is not None:
            probe.answered(channel, now)

    def time_received(self, address: Address, message: common.Timesync, now: float, channel: str) -> None:
        """Record a TIMESYNC of an address."""
        if (probe := self._probes.get(address)) is not None:
            probe.time_received(message, now, channel)

    def are_linked(self, address: Address, channels: tuple[str, ...]) -> bool:
        """Return whether questions over one channel are answered over another one, for all channels."""
        probe = self._probes.get(address)
        return probe is not None and probe.are_linked(channels)

    def round_trip(self, address: Address, channel: str, now: float, *, unknown: float) -> float:
        """Return the longest round trip of late to an address over a channel; `unknown` without any."""
        probe = self._probes.get(address)
        return unknown if probe is None else probe.round_trip(channel, now, unknown)

    def next_timeout(self) -> float | None:
        """Return when the next question is due."""
        if not self._probes:
            return None
        return earliest(*(probe.next_timeout() for probe in self._probes.values()))

    def questions(self, now: float) -> Iterator[Outgoing]:
        """Yield the questions that are due."""
        for probe in self._probes.values():
            yield from probe.questions(now)

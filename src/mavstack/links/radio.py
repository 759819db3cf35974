"""Simulated SiK telemetry radios: a half-duplex air link, a buffer at each end, and RADIO_STATUS.

A link with radios is opened by a URL with the option `radio=sik`, or by `sik_radio(link)`. Each channel has
a pair of radios: the near one is wired to the program, the far one to its peer. Both share the air, so that
data of one side delays the other side. A packet that finds the buffer of its radio full is dropped and
counted, as by the real firmware, which has no flow control by default.

A radio answers each HEARTBEAT of the program that it is wired to with a RADIO_STATUS, in MAVLink 1 and from
system 51, component 68 ("3D"); the message goes to that program only, not over the air. Its `txbuf` is the
free share of the radio's buffer in percent, from which autopilots and nodes learn the pace of the link. The
loss, latency and other options of impaired links apply to the air. Facts: firmware of SiK, `mavlink.c`,
`packet.c` and `serial.c`.
"""

from __future__ import annotations

import asyncio
from dataclasses import replace
from time import time
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.links.impaired import ImpairedChannel, ImpairedLink
from mavstack.links.impairment import Flow, Impairment
from mavstack.wire import Encoder, Parser

if TYPE_CHECKING:
    from mavstack.links.base import Link
    from mavstack.links.channel import Channel, Data
    from mavstack.links.events import BytesReceived
    from mavstack.links.inbox import Inbox

#: System and component id of SiK radios: the characters "3" and "D".
RADIO_ADDRESS: Final = (ord("3"), ord("D"))
#: Bandwidth of both directions together in bytes per second: 57,600 baud.
BANDWIDTH: Final = 5760.0
#: Size in bytes of a radio's buffer for packets that wait for transmission.
BUFFER: Final = 1850
#: Delay of a packet in seconds in addition to its transmission time: the radios take turns in time slots.
LATENCY: Final = 0.02
#: Signal and noise of a good link in the radio's unit: dBm = value / 1.9 - 127.
_RSSI, _NOISE = 180, 50
_HEARTBEAT = common.Heartbeat.definition.id
_MAX_COUNT = 0xFFFF


class Air:
    """The radio frequency that both radios of a pair share: one packet at a time."""

    def __init__(self, bandwidth: float) -> None:
        self._bandwidth = bandwidth
        self._idle_from = float("-inf")

    def transmit(self, size: int, now: float) -> float:
        """Transmit a packet after those that wait already; returns the time at which it has left."""
        self._idle_from = max(self._idle_from, now) + size / self._bandwidth
        return self._idle_from


class RadioFlow(Flow):
    """One direction of a pair of radios: the buffer of its sender, and the air.

    Args:
        impairment: The parameters; `queue` is the size of the buffer.
        name: Part of the random seed, so that both directions differ.
        air: The air that both directions share.
    """

    def __init__(self, impairment: Impairment, name: str, air: Air) -> None:
        super().__init__(impairment, name)
        self._air = air
        self._buffer_size = impairment.queue
        self._buffered: list[tuple[float, int]] = []  # (time at which the packet is transmitted, size)

    def free_percent(self, now: float) -> int:
        """Return the free share of the buffer in percent."""
        return max(round(100 * (1 - self._waiting(now) / self._buffer_size)), 0)

    def _depart(self, size: int, now: float) -> float | None:
        waiting = self._waiting(now)
        if waiting and waiting + size > self._buffer_size:
            return None
        departure = self._air.transmit(size, now)
        self._buffered.append((departure, size))
        return departure

    def _waiting(self, now: float) -> int:
        self._buffered = [entry for entry in self._buffered if entry[0] > now]
        return sum(size for _, size in self._buffered)


class Radio:
    """One radio of a pair: it reports the state of its link to the program that it is wired to."""

    def __init__(self, sending: RadioFlow, receiving: RadioFlow) -> None:
        self._sending, self._receiving = sending, receiving
        self._parser = Parser(common)
        self._encoder = Encoder(*RADIO_ADDRESS, version=1)

    def reports(self, data: bytes, now: float) -> list[bytes]:
        """Return a RADIO_STATUS for each HEARTBEAT in the data of the program."""
        packets = self._parser.feed(data)
        return [self._report(now) for packet in packets if packet.message_id == _HEARTBEAT]

    def _report(self, now: float) -> bytes:
        errors = self._receiving.stats.lost + self._receiving.stats.corrupted
        status = common.RadioStatus(
            rssi=_RSSI,
            remrssi=_RSSI,
            txbuf=self._sending.free_percent(now),
            noise=_NOISE,
            remnoise=_NOISE,
            rxerrors=min(errors, _MAX_COUNT),
            fixed=0,  # error correction is off by default
        )
        return self._encoder.encode(status)


class RadioChannel(ImpairedChannel):
    """A channel over a pair of radios."""

    def __init__(self, inner: Channel, inbox: Inbox, outgoing: RadioFlow, incoming: RadioFlow) -> None:
        super().__init__(inner, inbox, outgoing, incoming)
        self._near, self._far = Radio(outgoing, incoming), Radio(incoming, outgoing)
        self._loop = asyncio.get_running_loop()
        self._clock_offset = time() - self._loop.time()

    def receive(self, event: BytesReceived) -> None:
        """Pass data of the peer to the far radio, which may report to the peer."""
        super().receive(event)
        for report in self._far.reports(event.data, self._loop.time()):
            self._forward(report)

    def send_bytes(self, data: Data) -> bool:
        """Send or queue a chunk."""
        accepted = super().send_bytes(data)
        for report in self._near.reports(bytes(data), self._loop.time()):
            self._arrive(report)
        return accepted


class RadioLink(ImpairedLink):
    """A wrapper around another link, with a pair of radios in each channel."""

    def _new_channel(self, inner: Channel, number: int) -> RadioChannel:
        outgoing, incoming = self._models
        air = Air(outgoing.bandwidth)
        return RadioChannel(
            inner,
            self.inbox,
            RadioFlow(outgoing, f"{number} out", air),
            RadioFlow(incoming, f"{number} in", air),
        )


def sik_radio(link: Link, impairment: Impairment | None = None) -> Link:
    """Wrap a link that is not open yet, so that its channels go over simulated SiK radios.

    Args:
        link: The link; the wrapper opens and closes it.
        impairment: The impairment of the air; None for a good link. A `bandwidth` or `latency` of 0 is that
            of a SiK radio, and `queue` is at most the size of its buffer.

    Returns:
        The wrapped link.
    """
    given = impairment or Impairment()
    model = replace(
        given,
        bandwidth=given.bandwidth or BANDWIDTH,
        latency=given.latency or LATENCY,
        queue=max(min(given.queue, BUFFER), 1),
    )
    return RadioLink(link, model, model)

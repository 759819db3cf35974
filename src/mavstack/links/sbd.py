"""Iridium short burst data: `sbd+serial:///dev/ttyUSB0?baud=19200&interval=60`; needs the extra `serial`.

The modem behind the serial port carries messages, each of which holds the packets that were written
meanwhile; `sbd_modem` has the conversation. Use it with the profile of satellite links (`high_latency` of a
router), which sends one HIGH_LATENCY2 in place of the telemetry.
"""

from __future__ import annotations

import asyncio
from contextlib import suppress
from time import time
from typing import TYPE_CHECKING

from mavstack.errors import LinkClosedError
from mavstack.links.base import Link
from mavstack.links.channel import Channel
from mavstack.links.events import BytesReceived, ChannelClosed, ChannelOpened, LinkDown
from mavstack.links.sbd_modem import SbdModem
from mavstack.links.serial import SerialLink

if TYPE_CHECKING:
    from mavstack.links.channel import Data
    from mavstack.links.events import LinkEvent
    from mavstack.links.inbox import Inbox
    from mavstack.links.options import Options
    from mavstack.links.url import LinkURL

DEFAULT_INTERVAL = 60.0


class SbdChannel(Channel):
    """The gateway behind one modem."""

    def __init__(self, port: Channel, inbox: Inbox, modem: SbdModem) -> None:
        super().__init__(f"sbd {port.peer}", port.peer, inbox.remove_channel)
        #: The modem; it counts messages and credits.
        self.modem = modem
        self._port, self._inbox = port, inbox
        self._loop = asyncio.get_running_loop()
        self._timer: asyncio.TimerHandle | None = None
        self._run()

    def receive(self, data: bytes) -> None:
        """Process bytes of the modem."""
        self.modem.receive(data, self._loop.time())
        self._run()

    def send_bytes(self, data: Data) -> bool:
        """Queue a packet for the next message."""
        accepted = self.modem.send(bytes(data), self._loop.time())
        self._run()
        return accepted

    async def drain(self) -> None:
        """Return at once: old packets are dropped in favour of new ones."""

    def close_transport(self) -> None:
        """Stop the clock."""
        if self._timer is not None:
            self._timer.cancel()

    def _run(self) -> None:
        """Write to the modem, deliver its messages, and set the clock."""
        self.close_transport()
        if self.closed:
            return
        if data := self.modem.data_to_send():
            with suppress(LinkClosedError):
                self._port.write(data)
        for message in self.modem.take():
            self._inbox.offer(self, message, time())
        due = self.modem.next_timeout()
        self._timer = None if due is None else self._loop.call_at(due, self._expire)

    def _expire(self) -> None:
        self.modem.handle_timeout(self._loop.time())
        self._run()


class SbdLink(Link):
    """A link over one modem; its channel closes when the modem is unplugged."""

    def __init__(self, url: LinkURL, options: Options) -> None:
        super().__init__(url, options)
        self._interval = options.seconds("interval", DEFAULT_INTERVAL)
        self._poll = options.seconds("poll", 0.0)
        self._serial = SerialLink(url, options)
        self._channels: dict[Channel, SbdChannel] = {}

    async def open_transport(self) -> None:
        """Open the serial port."""
        await self._serial.open()
        for channel in self._serial.channels:
            self._add(channel)
        self.spawn(self._follow())

    async def stop_transport(self) -> None:
        """Close the serial port."""
        await self._serial.close()

    async def _follow(self) -> None:
        async for event in self._serial:
            self._handle(event)
        self.inbox.end()

    def _handle(self, event: LinkEvent) -> None:
        match event:
            case BytesReceived(channel, data) if channel in self._channels:
                self._channels[channel].receive(data)
            case ChannelOpened(channel) if channel not in self._channels:
                self._add(channel)
            case ChannelClosed(channel, reason) if channel in self._channels:
                self._channels.pop(channel).close(reason)
            case LinkDown(reason, retry_in):
                self.inbox.report_down(reason, retry_in)

    def _add(self, port: Channel) -> None:
        now = asyncio.get_running_loop().time()
        modem = SbdModem(now, interval=self._interval, poll=self._poll)
        self._channels[port] = channel = SbdChannel(port, self.inbox, modem)
        self.inbox.add_channel(channel)

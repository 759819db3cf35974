"""A link over a simulated Iridium modem on a pseudo terminal: HIGH_LATENCY2 out, a command back."""

from __future__ import annotations

import asyncio
import sys

import pytest

from mavstack import Parser, encode
from mavstack.dialects import common
from mavstack.links import BytesReceived, open_link
from mavstack.radio.sbd_terminal import SbdTerminal

pytest.importorskip("serial")
pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="pseudo terminals of POSIX")


async def test_packets_go_both_ways():
    report = encode(common.HighLatency2(custom_mode=4, battery=70), system=1, component=1)
    land = common.CommandLong(1, 1, command=common.MavCmd.NAV_RETURN_TO_LAUNCH)
    command = encode(land, system=255, component=190)
    async with (
        SbdTerminal(session_time=0.01) as terminal,
        open_link(f"sbd+serial://{terminal.device}?baud=19200&interval=0") as link,
    ):
        (channel,) = link.channels
        assert channel.write(report)
        assert not channel.write(bytes(341))
        terminal.modem.mailbox.append(command)
        async with asyncio.timeout(20):
            async for event in link:
                if isinstance(event, BytesReceived):
                    break
        assert event.data == command
        assert terminal.modem.sent == [report]
        (packet,) = Parser(common).feed(terminal.modem.sent[0])
        assert packet.message.battery == 70
        assert channel.modem.statistics.credits == terminal.modem.credits
        assert channel.counters.dropped_out == 1

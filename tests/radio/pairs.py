"""A simulated pair of radios over memory links, in virtual time."""

from __future__ import annotations

import asyncio
from contextlib import asynccontextmanager
from typing import TYPE_CHECKING

from mavstack.links import memory_pair
from mavstack.links.events import BytesReceived
from mavstack.radio import RadioPair, SikModem
from mavstack.radio.pseudo_terminals import PairDriver

if TYPE_CHECKING:
    from collections.abc import AsyncIterator


class Bench:
    """A pair with the program's modem at the near radio; `heard`: bytes at the far radio."""

    def __init__(self, modem: SikModem, pair: RadioPair, driver: PairDriver) -> None:
        self.modem, self.pair, self.driver = modem, pair, driver
        self.heard = bytearray()


@asynccontextmanager
async def bench(pair: RadioPair | None = None) -> AsyncIterator[Bench]:
    """Connect a modem to a pair that has been on for a while."""
    pair = pair or RadioPair()
    program, radio = memory_pair()
    await radio.open()
    await asyncio.sleep(5)
    modem = SikModem(program)
    heard = bytearray()
    driver = PairDriver(pair, lambda data: [each.write(data) for each in radio.channels], heard.extend)

    async def serve() -> None:
        async for event in radio:
            if isinstance(event, BytesReceived):
                driver.receive(0, event.data)

    server = asyncio.create_task(serve())
    try:
        async with modem:
            bench = Bench(modem, pair, driver)
            bench.heard = heard
            yield bench
    finally:
        await asyncio.sleep(0)
        server.cancel()
        driver.close()
        await radio.close()

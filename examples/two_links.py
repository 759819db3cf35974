"""Send packets over a lossy radio link to a UDP link, and count the lost ones."""

import asyncio

import mavstack
from mavstack.dialects import common
from mavstack.links import BytesReceived, Link

PACKETS = 200


async def receive(link: Link, parser: mavstack.Parser) -> None:
    """Parse received bytes until none arrive for half a second."""
    while True:
        try:
            event = await asyncio.wait_for(anext(link), timeout=0.5)
        except TimeoutError:
            return
        if isinstance(event, BytesReceived):
            parser.feed(event.data)


async def main() -> None:
    """Send numbered packets over a link that loses one in ten."""
    parser = mavstack.Parser(common)
    async with mavstack.open_link("udpin://127.0.0.1:0") as ground:
        host, port = ground.address or ("127.0.0.1", 0)
        async with mavstack.open_link(f"udpout://{host}:{port}?loss=0.1&latency=20ms&seed=7") as radio:
            (channel,) = radio.channels
            encoder = mavstack.Encoder(system=1, component=1)
            for step in range(PACKETS):
                channel.write(encoder.encode(common.Attitude(time_boot_ms=step)))
            await receive(ground, parser)
    source = parser.sources[1, 1]
    print(f"{source.received} of {PACKETS} arrived, {source.lost} were lost ({source.loss:.0%})")


asyncio.run(main())

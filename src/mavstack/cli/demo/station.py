"""The browser ground station beside the simulated fleet: `mav demo --web`."""

from __future__ import annotations

from contextlib import asynccontextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import AsyncIterator

    from mavstack.links import Link


@asynccontextmanager
async def station_served(link: Link, port: int) -> AsyncIterator[str]:
    """Serve the ground station to this machine while the block runs.

    Args:
        link: Link to the simulated vehicles.
        port: Port of the station; 0: a free one.

    Yields:
        The URL of the station.

    Raises:
        LinkError: The port cannot be listened on.
        MissingExtraError: The extra `web` is not installed.
    """
    from mavstack.http.server import serving
    from mavstack.server.access import Access
    from mavstack.server.app import make_app, make_early_answers
    from mavstack.server.station import Station
    from mavstack.vehicle import Connection

    async with Station(Connection(link), network_only=True) as station:
        access = Access()
        listening = serving(
            make_app(station, access),
            f"127.0.0.1:{port}",
            name="the ground station",
            websockets=True,
            comes_first=access.comes_first,
            answer_early=make_early_answers(station, access),
        )
        async with listening as (host, used_port):
            yield f"http://{host}:{used_port}/"

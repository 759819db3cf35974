"""Links to flight controllers that speak MSP: `msp+serial:///dev/ttyACM0`, `msp+tcp://127.0.0.1:5761`.

Behind such a link there is a bridge within the process, so that a flight controller is a MAVLink vehicle for
everything that opens links: connections, the router, recordings, the command line. The records of the schemes
(`schemes`) are entry points of the group `mavstack.links`, since links know nothing of bridges.

The option `system` is the system id of the vehicle, 1 by default; `baud` and the other options are those of
the link that carries MSP.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.bridges.msp.bridge import DEFAULT_SYSTEM, MspBridge
from mavstack.bridges.msp.flight_controller import FlightController
from mavstack.bridges.msp.transport import transport_url
from mavstack.errors import LinkError, LinkURLError, MspError
from mavstack.links import LinkURL
from mavstack.links.memory import MemoryLink, MemoryNetwork
from mavstack.links.options import Options
from mavstack.links.registry import plain_link

if TYPE_CHECKING:
    from mavstack.links import Link

_MAX_SYSTEM: Final = 255


class MspLink(MemoryLink):
    """A link whose only peer is the bridge of a flight controller."""

    def __init__(self, url: LinkURL, options: Options) -> None:
        network = MemoryNetwork()
        super().__init__(url, options, network, "program")
        self._peer = MemoryLink(
            LinkURL("memory", path="bridge"), Options(LinkURL("memory")), network, str(url)
        )
        system = options.integer("system", DEFAULT_SYSTEM)
        if system > _MAX_SYSTEM:
            raise LinkURLError(f"{url.redacted}: the option system={system} must be from 1 to {_MAX_SYSTEM}")
        carrier = transport_url(url)
        self._controller = FlightController(plain_link(carrier, options.of(carrier)))
        self._bridge = MspBridge(self._controller, self._peer, system=system)

    async def open_transport(self) -> None:
        """Open the transport of the link."""
        try:
            await self._controller.open()
            await self._bridge.open()
        except MspError as error:
            raise LinkError(f"cannot open {self.url.redacted}: {error}") from error
        self.connect(self._peer)

    async def stop_transport(self) -> None:
        """Stop accepting peers and bytes."""
        await self._bridge.close()
        await self._controller.close()


def open_link(url: LinkURL, options: Options) -> Link:
    """Create the link of a URL; the backend of the schemes `msp+serial` and `msp+tcp`."""
    return MspLink(url, options)

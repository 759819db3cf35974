"""The links of a replay: one for all packets, or one for each vehicle.

With `{system}` in the URL, as in `udpout://127.0.0.1:1455{system}`, the packets of each vehicle go to a link
of its own. Packets of other systems, such as ground stations, belong to none of these links: they are left
out and counted.
"""

from __future__ import annotations

from collections import defaultdict
from contextlib import AsyncExitStack
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.errors import UsageError
from mavstack.cli.common.output import echo
from mavstack.cli.watch.relay import Relay

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence
    from types import TracebackType
    from typing import Self

    from mavstack.links import Link
    from mavstack.wire import Packet

#: The placeholder of a vehicle's system id in the URL.
SYSTEM: Final = "{system}"


class VehicleRelays:
    """The outputs of a replay; an async context manager that opens and closes their links.

    Args:
        url: The URL, which may contain `{system}`.
        vehicles: Returns the system ids of the vehicles; called only if the URL contains `{system}`.

    Raises:
        UsageError: The URL contains `{system}`, and there is no vehicle.
        LinkURLError: A URL is invalid, or has options that would change packets.
        LinkError: A link cannot be opened.
    """

    def __init__(self, url: str, vehicles: Callable[[], Iterable[int]]) -> None:
        self._stack = AsyncExitStack()
        #: The output of each vehicle, by system id; empty if all packets are sent to `_common`.
        self._by_system: dict[int, Relay] = {}
        self._common: Relay | None = None
        if SYSTEM in url:
            self._by_system = {system: Relay(url.replace(SYSTEM, str(system))) for system in vehicles()}
            if not self._by_system:
                raise UsageError(f"--to contains {SYSTEM}, but the recording has no vehicle")
        else:
            self._common = Relay(url)
        #: Packets of systems without an output.
        self.omitted = 0

    @property
    def links(self) -> list[Link]:
        """The links."""
        return [relay.link for relay in self._relays]

    @property
    def activity(self) -> str:
        """The packets that were replayed, in words."""
        parts = [_sent_text(relay) for relay in self._relays]
        omitted = f" ({self.omitted} of other systems left out)" if self.omitted else ""
        return f"replayed {' and '.join(parts)}{omitted}"

    async def wait_for_peers(self, command: str) -> None:
        """Wait until each link has a peer.

        Args:
            command: Name of the command, for the notice that it waits.
        """
        for relay in self._relays:
            if not await relay.has_peer():
                echo(f"mav {command}: waiting for a peer on {relay.link.url.redacted}", error=True)
            await relay.wait_for_peer()

    def send(self, packets: Sequence[Packet]) -> None:
        """Write packets to their links."""
        if self._common is not None:
            self._common.send(packets)
            return
        chosen: defaultdict[int, list[Packet]] = defaultdict(list)
        for packet in packets:
            chosen[packet.system].append(packet)
        for system, some in chosen.items():
            relay = self._by_system.get(system)
            if relay is None:
                self.omitted += len(some)
            else:
                relay.send(some)

    async def drain(self) -> None:
        """Wait until all peers have room for more."""
        for relay in self._relays:
            await relay.drain()

    async def __aenter__(self) -> Self:
        try:
            for relay in self._relays:
                await self._stack.enter_async_context(relay)
        except BaseException:
            await self._stack.aclose()
            raise
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        await self._stack.aclose()

    @property
    def _relays(self) -> list[Relay]:
        return list(self._by_system.values()) if self._common is None else [self._common]


def _sent_text(relay: Relay) -> str:
    dropped = f", {relay.dropped} dropped" if relay.dropped else ""
    return f"{relay.sent} packets{dropped} to {relay.link.url.redacted}"

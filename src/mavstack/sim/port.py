"""The port of a simulated vehicle: its end of the connection to one peer."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from mavstack.node.channel_state import ChannelState
    from mavstack.security import SigningKey


@dataclass(eq=False, slots=True)
class Port:
    """The connection of a vehicle to one peer.

    Attributes:
        name: The name of the peer.
        key: The signing key; None for no signing.
        options: The capacity and the MAVLink version of the channel.
        state: The channel in the engine, new at each boot.
    """

    name: str
    key: SigningKey | None = None
    options: dict[str, Any] = field(default_factory=dict)
    state: ChannelState | None = None

    def limit(self, bandwidth: float | None, bulk_rate: float | None) -> None:
        """Change the capacity of the link; a bandwidth learned from RADIO_STATUS stays.

        Args:
            bandwidth: Bytes per second; None if unknown.
            bulk_rate: Packets of logs and files per second; None for no limit.
        """
        self.options |= {"bandwidth": bandwidth, "bulk_rate": bulk_rate}
        if self.state is not None:
            pacer = self.state.pacer
            pacer.bulk_rate = bulk_rate
            if not pacer.learned:
                pacer.bandwidth = bandwidth

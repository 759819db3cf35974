"""The installation of a signing key on a remote component."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.services.signing_setup import SigningSetupClient

if TYPE_CHECKING:
    from mavstack.node.clients import ComponentClients
    from mavstack.security import SigningKey


async def setup_signing(
    clients: ComponentClients, key: SigningKey | None, channel: str | None, timeout: float | None
) -> None:
    """Install a signing key; `channel` is the name of the channel for a first key."""
    host, address = clients.host, clients.address
    key_channels = host.engine.key_channels

    def make() -> SigningSetupClient:
        return SigningSetupClient(
            host.address,
            address,
            key_refusal=key_channels.refusal,
            arrived_elsewhere=host.engine.arrived_elsewhere,
        )

    client = clients.get(SigningSetupClient, make)
    if channel is not None and key is not None:
        key_channels.name(address, channel)
    try:
        await host.finish(client, client.install(key, host.now(), timeout=timeout))
    finally:
        if not client.changing:
            key_channels.release(address)

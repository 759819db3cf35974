"""The terrain that a remote component has: `component.terrain`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.node.api_object import ReadOnly
from mavstack.services.terrain import TerrainCheckClient

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.node.clients import ComponentClients
    from mavstack.services.terrain import Position, TerrainState


class Terrain(ReadOnly):
    """The terrain that a vehicle has from ground stations (TERRAIN_CHECK, TERRAIN_REPORT)."""

    def __init__(self, clients: ComponentClients) -> None:
        self._clients = clients

    @property
    def _client(self) -> TerrainCheckClient:
        return self._clients.get(TerrainCheckClient)

    async def check(self, latitude: float, longitude: float, *, timeout: float | None = None) -> TerrainState:
        """Ask for the terrain that the vehicle has at a position; it requests what it lacks there.

        Args:
            latitude: Degrees.
            longitude: Degrees.
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Returns:
            The height of the terrain if the vehicle has it, and how many tiles it has and waits for.

        Raises:
            InvalidTypeError: An argument is not a number.
            InvalidArgumentError: The position is not on Earth.
            RemoteTimeout: The vehicle does not answer; PX4 does not have this protocol.
            RemoteCancelled: The node was closed.
        """
        host, client = self._clients.host, self._client
        return await host.finish(client, client.check(latitude, longitude, host.now(), timeout=timeout))

    async def wait_until_loaded(
        self,
        *positions: Position,
        timeout: float | None = None,
        progress: Callable[[int, int], None] | None = None,
    ) -> None:
        """Wait until the vehicle has the terrain of all positions, such as the waypoints of a mission.

        Args:
            positions: Latitudes and longitudes in degrees.
            timeout: Seconds for the whole call; None: until no tile arrived for a minute.
            progress: Called with the positions whose terrain the vehicle has, and all positions.

        Raises:
            InvalidTypeError: A position is not two numbers.
            InvalidArgumentError: A position is not on Earth.
            RemoteTimeout: The vehicle does not answer, or no ground station sends it the terrain.
            RemoteCancelled: The node was closed.
        """
        host, client = self._clients.host, self._client
        operation = client.wait_until_loaded(positions, host.now(), timeout=timeout)
        await host.finish(client, operation, progress)

"""The plans of a vehicle: its mission, its fence, its rally points."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.services.mission import Plan, PlanType, set_current_item

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from mavstack.node.remote import RemoteComponent
    from mavstack.services.mission import MissionItem, MissionProgress


class Plans:
    """One kind of plan of one vehicle; raises `MissionDenied` or `MissionTimeout`."""

    def __init__(self, remote: RemoteComponent, plan_type: int) -> None:
        self._remote = remote
        self.type = plan_type

    async def upload(
        self,
        items: Plan | Iterable[MissionItem],
        *,
        timeout: float | None = None,
        progress: Callable[[int, int], None] | None = None,
    ) -> Plan:
        """Give the vehicle a plan in the place of its own; the result has the vehicle's id of it.

        The vehicle holds either the old plan or the whole new one, whatever happens on the way.
        """
        plan = items if isinstance(items, Plan) else Plan.of(items, self.type)
        client, node = self._remote.mission_client, self._remote.node
        return await node.driver.finish(client, client.upload(plan, node.now(), limit=timeout), progress)

    async def download(
        self, *, timeout: float | None = None, progress: Callable[[int, int], None] | None = None
    ) -> Plan:
        """Get the plan that the vehicle holds."""
        client, node = self._remote.mission_client, self._remote.node
        operation = client.download(node.now(), self.type, limit=timeout)
        return await node.driver.finish(client, operation, progress)

    async def clear(self, *, timeout: float | None = None) -> None:
        """Let the vehicle forget the plan."""
        client, node = self._remote.mission_client, self._remote.node
        await node.driver.finish(client, client.clear(node.now(), self.type, limit=timeout))

    async def set_current(self, seq: int, *, reset: bool = False) -> None:
        """Let the mission go on at an item; `reset` lets it begin anew, its jump counters too."""
        client = self._remote.command_client
        await self._remote.node.perform(client, set_current_item(seq, reset=reset))

    @property
    def progress(self) -> MissionProgress | None:
        """Where the vehicle said last that it is in its mission."""
        return self._remote.mission_client.progress if self.type == PlanType.MISSION else None

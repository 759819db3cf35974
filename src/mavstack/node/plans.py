"""The plans of a vehicle: its mission, its fence, its rally points."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.errors import CommandDenied, CommandTimeout
from mavstack.services.mission import Plan, PlanType, set_current_item

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from mavstack.node.component import RemoteComponent
    from mavstack.services.mission import MissionItem, MissionProgress

#: How long to wait for an answer to the newer way of setting the current item, before trying the older one.
SET_CURRENT_TIMEOUT = 6.0


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
        return await node.driver.finish(client, client.upload(plan, node.now(), timeout=timeout), progress)

    async def download(
        self, *, timeout: float | None = None, progress: Callable[[int, int], None] | None = None
    ) -> Plan:
        """Get the plan that the vehicle holds."""
        client, node = self._remote.mission_client, self._remote.node
        operation = client.download(node.now(), self.type, timeout=timeout)
        return await node.driver.finish(client, operation, progress)

    async def clear(self, *, timeout: float | None = None) -> None:
        """Let the vehicle forget the plan."""
        client, node = self._remote.mission_client, self._remote.node
        await node.driver.finish(client, client.clear(node.now(), self.type, timeout=timeout))

    async def set_current(self, seq: int, *, restart: bool = False) -> None:
        """Let the mission go on at an item; `restart` lets it begin anew, its jump counters too.

        A vehicle that does not know the command, or leaves it unanswered, is told by MISSION_SET_CURRENT.
        """
        client, node = self._remote.mission_client, self._remote.node
        try:
            asked = set_current_item(seq, reset=restart, timeout=SET_CURRENT_TIMEOUT)
            await node.run_operation(self._remote.command_client, asked)
        except (CommandDenied, CommandTimeout) as error:
            unknown = isinstance(error, CommandTimeout) or error.code == common.MavResult.UNSUPPORTED
            if restart or not unknown:
                raise
            await node.driver.finish(client, client.set_current(seq, node.now()))

    @property
    def progress(self) -> MissionProgress | None:
        """Where the vehicle said last that it is in its mission."""
        return self._remote.mission_client.progress if self.type == PlanType.MISSION else None

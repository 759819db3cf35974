"""The plans of a remote component: `component.mission`, `component.fence`, `component.rally`."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.errors import CommandDenied, CommandTimeout, InvalidTypeError
from mavstack.node.api_object import ReadOnly
from mavstack.node.firmware import has_home_item_first
from mavstack.node.subscription import DEFAULT_QUEUE
from mavstack.node.time_budget import TimeBudget
from mavstack.services.mission import (
    ItemReached,
    MissionClient,
    MissionItem,
    Plan,
    PlanType,
    set_current_item,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from mavstack.node.clients import ComponentClients
    from mavstack.node.subscription import Subscription
    from mavstack.services.mission import MissionProgress

#: Seconds to wait for an answer to MAV_CMD_DO_SET_MISSION_CURRENT before MISSION_SET_CURRENT is tried.
SET_CURRENT_TIMEOUT = 6.0


class Plans(ReadOnly):
    """The plan of one type on a remote component, by the mission protocol.

    Every method raises `MissionDenied` if the component refuses (its `code` is the MAV_MISSION_RESULT),
    `MissionTimeout` if it does not answer, and `RemoteCancelled` if the node is closed during the call.
    """

    type: int

    def __init__(self, clients: ComponentClients, plan_type: int) -> None:
        self._clients = clients
        #: The MAV_MISSION_TYPE of the plan.
        self.type = plan_type
        self._uploaded: Plan | None = None

    @property
    def _client(self) -> MissionClient:
        clients = self._clients

        def make() -> MissionClient:
            home_first = has_home_item_first(clients.info)
            return MissionClient(clients.host.address, clients.address, home_first=home_first)

        return clients.get(MissionClient, make)

    @property
    def home_first(self) -> bool:
        """True if item 0 of a mission is the home position, as with ArduPilot."""
        return self._client.home_first

    def reached_items(self) -> Subscription[ItemReached]:
        """Subscribe to the mission items that the component reaches (MISSION_ITEM_REACHED).

        Returns:
            An async iterator over `ItemReached`; close it, or use it as an async context manager.
        """
        client = self._client
        return self._clients.host.events(ItemReached, of=client, queue=DEFAULT_QUEUE)

    async def upload(
        self,
        items: Plan | Iterable[MissionItem],
        *,
        timeout: float | None = None,
        progress: Callable[[int, int], None] | None = None,
    ) -> Plan:
        """Replace the component's plan atomically: it holds either the old plan or the whole new one.

        Args:
            items: The new plan; latitudes and longitudes in degrees, altitudes in metres in the item's frame.
            timeout: Seconds for the whole call; None: until retries are exhausted or progress stalls.
            progress: Called with the items sent and the items in total.

        Returns:
            The plan, with the id that the component gave it (0 if it gives none).

        Raises:
            InvalidTypeError: An item is not a `MissionItem`.
            MissionDenied: The component refused the plan.
            MissionTimeout: The component does not answer.
        """
        plan = items if isinstance(items, Plan) else Plan.of(items, self.type)
        for number, item in enumerate(plan.items):
            if not isinstance(item, MissionItem):
                raise InvalidTypeError(f"items[{number}] must be a MissionItem, got {item!r:.60}")
        host, client = self._clients.host, self._client
        plan = self._named(plan)
        held = await host.finish(client, client.upload(plan, host.now(), timeout=timeout), progress)
        self._uploaded = held
        return held

    def _named(self, plan: Plan) -> Plan:
        """Return the plan with members of the dialect for plain numbers, so that errors name the commands."""
        named = [self._clients.host.named_command(item.command) for item in plan.items]
        if all(name is item.command for name, item in zip(named, plan.items, strict=True)):
            return plan
        items = (replace(item, command=name) for name, item in zip(named, plan.items, strict=True))
        return replace(plan, items=tuple(items))

    async def download(
        self, *, timeout: float | None = None, progress: Callable[[int, int], None] | None = None
    ) -> Plan:
        """Download the plan.

        Args:
            timeout: Seconds for the whole call; None: until retries are exhausted or progress stalls.
            progress: Called with the items received and the items in total.

        Returns:
            The plan; latitudes and longitudes in degrees, altitudes in metres in the item's frame. ArduPilot
            keeps its home in item 0: if nothing else differs from the plan that was uploaded through this
            object, item 0 is as uploaded; `Vehicle.home` is the home position.

        Raises:
            MissionDenied: The component refused.
            MissionTimeout: The component does not answer.
        """
        host, client = self._clients.host, self._client
        operation = client.download(host.now(), self.type, timeout=timeout)
        return self._as_uploaded(await host.finish(client, operation, progress))

    def _as_uploaded(self, held: Plan) -> Plan:
        """Return the uploaded plan if the vehicle's differs only in item 0, which is its home."""
        sent = self._uploaded
        if not self.home_first or self.type != PlanType.MISSION or sent is None or sent == held:
            return held
        if len(sent) != len(held) or sent.items[1:] != held.items[1:]:
            return held
        return sent.with_id(held.plan_id)

    async def clear(self, *, timeout: float | None = None) -> None:
        """Remove the plan (MISSION_CLEAR_ALL).

        Args:
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Raises:
            MissionDenied: The component refused.
            MissionTimeout: The component does not answer.
        """
        host, client = self._clients.host, self._client
        await host.finish(client, client.clear(host.now(), self.type, timeout=timeout))

    async def set_current(self, seq: int, *, restart: bool = False, timeout: float | None = None) -> None:
        """Set the current mission item (MAV_CMD_DO_SET_MISSION_CURRENT).

        A component that does not know the command or does not answer it gets MISSION_SET_CURRENT instead.

        Args:
            seq: The sequence number of the item.
            restart: Reset the mission as well, jump counters included.
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Raises:
            CommandDenied: The component refused the command.
            CommandTimeout: The component does not answer, and `restart` is set.
            MissionTimeout: The component does not answer.
        """
        host, client = self._clients.host, self._client
        budget = TimeBudget(timeout, host.now)
        try:
            operation = set_current_item(seq, restart=restart, timeout=budget.remaining(SET_CURRENT_TIMEOUT))
            await host.run_operation(self._clients.command, operation)
        except (CommandDenied, CommandTimeout) as error:
            unknown = isinstance(error, CommandTimeout) or error.code == common.MavResult.UNSUPPORTED
            if restart or not unknown:
                raise
            await host.finish(client, client.set_current(seq, host.now(), timeout=budget.remaining()))

    @property
    def progress(self) -> MissionProgress | None:
        """The progress of a mission (MISSION_CURRENT); None if not received, or for other plans."""
        return self._client.progress if self.type == PlanType.MISSION else None

"""Missions of iNav by the mission protocol; with Betaflight every transfer is answered UNSUPPORTED.

An uploaded plan is converted (`waypoints`), written waypoint by waypoint, read back and then acknowledged, so
that an accepted plan is the plan that iNav flies. iNav has no command to remove a mission: a list whose last
waypoint lacks its flag is not valid, and counts as empty here. `PREFLIGHT_STORAGE` saves the mission too.
"""

from __future__ import annotations

import asyncio
import logging
from itertools import zip_longest
from typing import TYPE_CHECKING, Final

from mavstack.bridges.msp.telemetry import StreamedMessage, millimeters
from mavstack.bridges.msp.waypoints import ItemRefused, item_numbers, items_of, waypoints_of
from mavstack.dialects import common
from mavstack.errors import InvalidStateError, LinkError, MspError, RemoteCancelled
from mavstack.msp.messages.gps import RawGps
from mavstack.msp.messages.navigation import (
    HOME_WAYPOINT,
    GetWp,
    NavMode,
    NavStatus,
    SetWp,
    SetWpIndex,
    WaypointAction,
    Wp,
    WpInfo,
    WpMissionSave,
)
from mavstack.msp.messages.sensors import Altitude
from mavstack.services.mission import CurrentItemSet, MissionServer, MissionServerOptions, Plan, PlanType

if TYPE_CHECKING:
    from collections.abc import Callable, Coroutine

    from mavstack.bridges.msp.flight_controller import FlightController
    from mavstack.bridges.msp.samples import Samples
    from mavstack.msp.messages.base import MspMessage
    from mavstack.node import Node
    from mavstack.services import Address
    from mavstack.services.mission import MissionItem

#: Number of waypoints if iNav does not report it.
DEFAULT_MAX_WAYPOINTS: Final = 120
#: Seconds between two polls of the state of the navigation, of the size of the mission and of home.
NAV_INTERVAL, INFO_INTERVAL, HOME_INTERVAL = 1.0, 5.0, 5.0
_RESULT: Final = common.MavMissionResult
_FAILURES = (MspError, LinkError, RemoteCancelled, InvalidStateError)

logger = logging.getLogger("mavstack.bridges.msp")


class BridgedMissions:
    """The missions of one bridge.

    Args:
        node: The node of the bridge.
        controller: The flight controller.
        samples: The latest MSP messages.
        report: Sends a status text with a MAV_SEVERITY.
    """

    def __init__(
        self,
        node: Node,
        controller: FlightController,
        samples: Samples,
        report: Callable[[str, int], None],
    ) -> None:
        self._node, self._controller, self._samples, self._report = node, controller, samples, report
        self.is_supported = controller.info.is_inav
        limits = {int(PlanType.MISSION): DEFAULT_MAX_WAYPOINTS} if self.is_supported else {}
        self.server = MissionServer(
            node.address,
            options=MissionServerOptions(limits=limits),
            check=self._check,
            validate=self._validate,
            store_elsewhere=self._store_later,
        )
        self._busy = asyncio.Lock()
        self._tasks: set[asyncio.Task[None]] = set()
        self._numbers: list[int] = []
        self._home: Wp | None = None
        node.serve(self.server)
        if self.is_supported:
            self.server.answer_commands(node.commands.server, self._wake_later)

    def polled(self) -> dict[type[MspMessage], float]:
        """Return the messages to poll, and their intervals in seconds."""
        return {NavStatus: NAV_INTERVAL, WpInfo: INFO_INTERVAL} if self.is_supported else {}

    def streamed(self) -> tuple[StreamedMessage, ...]:
        """Return the messages to stream."""
        if not self.is_supported:
            return ()
        return (
            StreamedMessage(common.MissionCurrent, (NavStatus,), 1.0, self.server.current_message),
            StreamedMessage(common.HomePosition, (NavStatus,), 5.0, self._home_position),
        )

    async def run(self) -> None:
        """Follow home, and the current item that clients set, for ever."""
        if not self.is_supported:
            return
        async with asyncio.TaskGroup() as tasks:
            tasks.create_task(self._follow_home())
            async with self._node.events(CurrentItemSet, of=self.server) as events:
                async for event in events:
                    await self._set_current(event)

    async def load(self) -> None:
        """Read the mission of the flight controller."""
        if not self.is_supported:
            return
        async with self._busy:
            waypoints = await self._read()
        items, self._numbers = items_of(waypoints)
        plan = Plan.of(items)
        if plan != self.server.store.get(PlanType.MISSION):
            self.server.replace(plan)
            self._node.wake(self.server)

    async def save(self) -> None:
        """Save the mission; iNav refuses to save one without waypoints, so that is left out."""
        if self.is_supported and self._numbers:
            await self._controller.send(WpMissionSave())

    def receive(self, message: MspMessage) -> None:
        """Take a polled message: the state of the navigation, the size of the mission."""
        match message:
            case NavStatus():
                self._follow(message)
            case WpInfo(is_valid=valid, waypoint_count=count) if not self._busy.locked():
                if (count if valid else 0) != len(self._numbers):
                    self._spawn_load()

    def _wake_later(self, server: MissionServer) -> None:
        """Process the mission server after the handler of a command that calls this."""
        asyncio.get_running_loop().call_soon(self._node.wake, server)

    # Uploads

    def _check(self, _plan_type: int, _seq: int, _item: MissionItem) -> int:
        return _RESULT.ACCEPTED  # items depend on each other: `_validate` checks the plan

    def _validate(self, plan: Plan, source: Address) -> int:
        try:
            waypoints_of(plan.items)
        except ItemRefused as error:
            self._node.send(
                common.Statustext(severity=common.MavSeverity.WARNING, text=f"Mission: {error}"[:50]), source
            )
            return error.result
        return _RESULT.ACCEPTED

    def _store_later(self, plan: Plan, source: Address) -> None:
        self._spawn(self._store(plan, source))

    async def _store(self, plan: Plan, source: Address) -> None:
        result = _RESULT.ACCEPTED
        try:
            async with self._busy:
                await self._write(waypoints_of(plan.items))
            self._numbers = item_numbers(plan.items)
        except _FAILURES as error:
            self._report(str(error), common.MavSeverity.ERROR)
            result = _RESULT.ERROR
        self.server.finish_storing(plan, source, result, self._node.now())
        self._node.wake(self.server)

    async def _write(self, waypoints: list[SetWp]) -> None:
        """Write waypoints and read them back; raises `MspError` if iNav did not take them."""
        removed = SetWp(1, WaypointAction.RTH, 0.0, 0.0, 0.0, 0, 0, 0, 0)
        for waypoint in waypoints or [removed]:
            await self._controller.send(waypoint)
        stored, info = await self._read(), self._controller.info
        pairs = zip_longest((each.encode(info) for each in waypoints), (each.encode(info) for each in stored))
        number = next((number for number, (wanted, found) in enumerate(pairs, 1) if wanted != found), None)
        if number is not None:
            raise MspError(
                "writing the mission to",
                self._controller.name,
                answer=f"it did not take waypoint {number}; iNav keeps its mission while it flies one",
            )

    async def _read(self) -> list[Wp]:
        info = await self._controller.get(WpInfo)
        self.server.limits[int(PlanType.MISSION)] = info.max_waypoints or DEFAULT_MAX_WAYPOINTS
        count = info.waypoint_count if info.is_valid else 0
        return [await self._controller.get(Wp, GetWp(index)) for index in range(1, count + 1)]

    def _spawn_load(self) -> None:
        async def load() -> None:
            try:
                await self.load()
            except _FAILURES as error:
                logger.warning("%s", error)

        self._spawn(load())

    def _spawn(self, work: Coroutine[None, None, None]) -> None:
        task = asyncio.get_running_loop().create_task(work)
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    # Navigation state and home

    def _follow(self, status: NavStatus) -> None:
        flying = status.mode is NavMode.NAV
        states = common.MissionState
        self.server.state = states.ACTIVE if flying else states.NOT_STARTED
        self.server.mode = 1 if flying else 2
        place = status.waypoint - 1
        if not flying or not 0 <= place < len(self._numbers):
            return
        number, before = self._numbers[place], self.server.current
        if number != before:
            if number > before:
                self.server.reached(before)
            self.server.set_current(number)
            self._node.wake(self.server)

    async def _set_current(self, event: CurrentItemSet) -> None:
        place = next((index for index, number in enumerate(self._numbers) if number >= event.seq), None)
        if place is None:
            return
        try:
            await self._controller.send(SetWpIndex(place))
        except _FAILURES as error:
            # iNav refuses this unless it flies a mission; the next mission then begins at its first item.
            logger.info("%s", error)

    async def _follow_home(self) -> None:
        while True:
            try:
                home = await self._controller.get(Wp, GetWp(HOME_WAYPOINT))
                self._home = home if home.latitude or home.longitude else None
            except _FAILURES:
                self._home = None
            await asyncio.sleep(HOME_INTERVAL)

    def _home_position(self) -> common.HomePosition | None:
        gps, altitude = self._samples.get(RawGps), self._samples.get(Altitude)
        if self._home is None or gps is None or altitude is None:
            return None
        above_sea = gps.altitude - altitude.altitude  # the altitude of the waypoint is relative to home
        return common.HomePosition(
            latitude=round(self._home.latitude * 1e7),
            longitude=round(self._home.longitude * 1e7),
            altitude=millimeters(above_sea),
            q=(1.0, 0.0, 0.0, 0.0),
        )

"""Actions of ROS 2 without transport: three services and two topics for each, as rosidl makes them.

    send_goal ──► EXECUTING ── done ──► SUCCEEDED
                      │ └── error of the vehicle ──► ABORTED, with its reason in the result
                      └── cancel_goal ──► CANCELING ──► CANCELED: the vehicle holds its position

A new goal of one action replaces the one under way, which is aborted. Results are kept for a while, since a
client asks for them after the goal was reached.
"""

from __future__ import annotations

import asyncio
from contextlib import suppress
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Final

from mavstack.bridges.core.endpoints import NO_CONTROL, ServiceEndpoint
from mavstack.bridges.core.qos import DEFAULT, LATCHED
from mavstack.bridges.core.row import Action, Publication
from mavstack.bridges.core.topic import Topic
from mavstack.bridges.core.types import codec_of
from mavstack.bridges.core.types.cdr import flatten
from mavstack.errors import MavstackError

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.vehicle import Vehicle

Fields = dict[str, Any]
ACCEPTED, EXECUTING, CANCELING, SUCCEEDED, CANCELED, ABORTED = range(1, 7)
_ENDED: Final = (SUCCEEDED, CANCELED, ABORTED)
_CANCEL_OK, _CANCEL_UNKNOWN, _CANCEL_TERMINATED = 0, 2, 3
#: Seconds between two feedback messages.
FEEDBACK_INTERVAL: Final = 0.5
#: Maximum number of results that are kept.
MAX_RESULTS: Final = 32
_NO_GOAL: Final = bytes(16)


@dataclass(slots=True)
class Goal:
    """A goal that was accepted."""

    id: bytes
    fields: Fields
    accepted: int
    status: int = EXECUTING
    reason: str = ""
    task: asyncio.Task[None] | None = None
    ended: asyncio.Event = field(default_factory=asyncio.Event)


class ActionServer:
    """The server of one action of one vehicle.

    Args:
        row: The row.
        name: The full name, such as "/mavros/action/takeoff".
        vehicle: The vehicle.
        now: Returns the Unix time in nanoseconds.
        allowed: The role of the bridge suffices.
        reject: Called with the text of each failure.
        node: The full name of its node.
    """

    def __init__(
        self,
        row: Action,
        name: str,
        vehicle: Vehicle,
        now: Callable[[], int],
        *,
        allowed: bool,
        reject: Callable[[str], None],
        node: str = "",
    ) -> None:
        self.row = row
        self.name = name
        self._vehicle = vehicle
        self._now = now
        self._allowed = allowed
        self._reject = reject
        self._goals: dict[bytes, Goal] = {}
        prefix = f"{name}/_action"
        self.services = (
            ServiceEndpoint(
                f"{prefix}/send_goal", f"{row.type}_SendGoal", self._send_goal, reject=reject, node=node
            ),
            ServiceEndpoint(
                f"{prefix}/cancel_goal", "action_msgs/srv/CancelGoal", self._cancel, reject=reject, node=node
            ),
            ServiceEndpoint(
                f"{prefix}/get_result", f"{row.type}_GetResult", self._get_result, reject=reject, node=node
            ),
        )
        feedback = Publication("feedback", f"{row.type}_FeedbackMessage", (), None, DEFAULT)
        status = Publication("status", "action_msgs/msg/GoalStatusArray", (), None, LATCHED)
        self.feedback = Topic(feedback, f"{prefix}/feedback", node=node)
        self.status = Topic(status, f"{prefix}/status", node=node)

    async def close(self) -> None:
        """Cancel all goals; the vehicle is not told to hold."""
        tasks = [goal.task for goal in self._goals.values() if goal.task is not None]
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)

    # Requests

    async def _send_goal(self, request: Fields) -> Fields:
        now = self._now()
        stamp = dict(zip(("sec", "nanosec"), divmod(now, 1_000_000_000), strict=True))
        if not self._allowed:
            self._reject(f"{self.name}: {NO_CONTROL}")
            return {"accepted": False, "stamp": stamp}
        identity = bytes(request["goal_id"]["uuid"])
        if identity in self._goals:
            return {"accepted": False, "stamp": stamp}
        await self._replace_running()
        goal = self._goals[identity] = Goal(identity, request["goal"], now)
        goal.task = asyncio.get_running_loop().create_task(self._run(goal))
        self._forget_old()
        self._publish_status()
        return {"accepted": True, "stamp": stamp}

    async def _replace_running(self) -> None:
        for goal in self._goals.values():
            if goal.status not in _ENDED and goal.task is not None:
                goal.reason = "another goal replaced it"
                goal.task.cancel()
                await asyncio.gather(goal.task, return_exceptions=True)

    async def _cancel(self, request: Fields) -> Fields:
        info = request["goal_info"]
        identity = bytes(info["goal_id"]["uuid"])
        until = info["stamp"]["sec"] * 1_000_000_000 + info["stamp"]["nanosec"]
        if identity != _NO_GOAL and identity not in self._goals:
            return {"return_code": _CANCEL_UNKNOWN}
        wanted = [
            goal
            for goal in self._goals.values()
            if goal.id == identity or (identity == _NO_GOAL and (not until or goal.accepted <= until))
        ]
        running = [goal for goal in wanted if goal.status not in _ENDED]
        for goal in running:
            goal.status = CANCELING
            if goal.task is not None:
                goal.task.cancel()
        self._publish_status()
        code = _CANCEL_TERMINATED if identity != _NO_GOAL and not running else _CANCEL_OK
        return {"return_code": code, "goals_canceling": [_info(goal) for goal in running]}

    async def _get_result(self, request: Fields) -> Fields:
        goal = self._goals.get(bytes(request["goal_id"]["uuid"]))
        if goal is None:
            return {"status": 0, "result": {"success": False, "reason": "there is no such goal"}}
        await goal.ended.wait()
        result = {"success": goal.status == SUCCEEDED, "reason": goal.reason}
        return {"status": goal.status, "result": result}

    # Running a goal

    async def _run(self, goal: Goal) -> None:
        loop = asyncio.get_running_loop()
        feedback = loop.create_task(self._give_feedback(goal))
        try:
            await self.row.run(self._vehicle, goal.fields)
            goal.status = SUCCEEDED
        except asyncio.CancelledError:
            await self._end_cancelled(goal)
        except Exception as error:  # noqa: BLE001 (a goal may hold anything)
            goal.status, goal.reason = ABORTED, str(error) or type(error).__name__
            self._reject(f"{self.name}: {goal.reason}")
        finally:
            feedback.cancel()
            goal.ended.set()
            self._publish_status()

    async def _end_cancelled(self, goal: Goal) -> None:
        if goal.status != CANCELING:  # a new goal replaced this one, or the bridge ends
            goal.status, goal.reason = ABORTED, goal.reason or "the bridge ended"
            return
        goal.status, goal.reason = CANCELED, "cancelled; the vehicle holds its position"
        try:
            await self._vehicle.hold()
        except MavstackError as error:
            goal.reason = f"cancelled; {error}"

    async def _give_feedback(self, goal: Goal) -> None:
        while True:
            with suppress(Exception):
                fields = self.row.feedback(self._vehicle, goal.fields)
                message = {"goal_id": {"uuid": goal.id}, "feedback": fields}
                definition = codec_of(self.feedback.type).definition
                self.feedback.publish(flatten(definition, message), self._now())
            await asyncio.sleep(FEEDBACK_INTERVAL)

    def _publish_status(self) -> None:
        entries = tuple(
            (*goal.id, *divmod(goal.accepted, 1_000_000_000), goal.status) for goal in self._goals.values()
        )
        self.status.publish((entries,), self._now())

    def _forget_old(self) -> None:
        ended = [key for key, goal in self._goals.items() if goal.status in _ENDED]
        for key in ended[: max(len(self._goals) - MAX_RESULTS, 0)]:
            del self._goals[key]


def _info(goal: Goal) -> Fields:
    stamp = dict(zip(("sec", "nanosec"), divmod(goal.accepted, 1_000_000_000), strict=True))
    return {"goal_id": {"uuid": goal.id}, "stamp": stamp}

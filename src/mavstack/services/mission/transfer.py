"""The base of uploads, downloads and clearing on the client side.

Only one transfer to a vehicle runs at a time, whatever its plan type: PX4 has one state for all of them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

from mavstack.dialects import common
from mavstack.errors import MissionDenied, MissionTimeout, RemoteCancelled
from mavstack.services.mission.stale_messages import SETTLE, StaleMessages
from mavstack.services.operation import Operation
from mavstack.services.timing import RoundTrip

if TYPE_CHECKING:
    from mavstack.dialects import Message
    from mavstack.errors import MavstackError
    from mavstack.services.service import Priority
    from mavstack.wire import Packet

Result = TypeVar("Result")

#: Seconds without progress after which a transfer fails.
IDLE_TIMEOUT = 10.0
#: How often a transfer is restarted because the vehicle lost its state.
MAX_ROUNDS = 4


class Transfer(Operation[Result]):
    """A transfer of a plan of one type."""

    timeout_error = MissionTimeout
    #: True if the transfer changes the vehicle's plan.
    writes = False

    def __init__(self, description: str, plan_type: int, timeout: float | None) -> None:
        super().__init__(description, timeout=timeout, idle_timeout=IDLE_TIMEOUT)
        self.type = int(plan_type)
        self.begun = False
        self.tries = 0  # the number of times the last message was sent
        self.sent_at = 0.0
        self._not_before = 0.0
        self._ignores_first = False
        self._stale_messages = StaleMessages()
        self._round_trip = RoundTrip()

    def open(self, now: float) -> None:
        """Send the first message."""
        raise NotImplementedError

    def handle_message(self, packet: Packet, now: float) -> None:
        """Handle a message about plans of this type."""
        raise NotImplementedError

    def handle_silence(self, now: float) -> None:
        """Handle a timeout of the last message."""
        raise NotImplementedError

    def join(self, stale_messages: StaleMessages, round_trip: RoundTrip) -> None:
        """Use the client's state of its vehicle."""
        self._stale_messages, self._round_trip = stale_messages, round_trip

    def start(self, now: float) -> None:
        due = max(self._stale_messages.earliest_start(self.type, self.writes), self._not_before)
        if now >= due:
            self._open(now)
        else:
            self.begun, self.timer = False, due

    def receive(self, packet: Packet, now: float) -> None:
        kind = getattr(packet.message, "mission_type", None)
        if kind is None or self.type not in (kind, common.MavMissionType.ALL):
            return
        if not self.begun:
            self.start(now)  # the transfer may have waited for this message
            return
        self._stale_messages.record(self.type, self.writes, now)
        if self._ignores_first:
            self._stale_messages.held_back = False
            self.pause(SETTLE, now)
        else:
            self.handle_message(packet, now)

    def pause(self, seconds: float, now: float) -> None:
        """Restart after some seconds, and ignore messages until then."""
        self._not_before = now + seconds
        self.start(now)

    def handle_timeout(self, now: float) -> None:
        if self.begun:
            self.handle_silence(now)
        else:
            self.start(now)

    def finish(self, result: Result) -> None:
        if not self.done:
            self._stale_messages.ended(self.type, success=True)
        super().finish(result)

    def fail(self, error: MavstackError) -> None:
        if not self.done and self.begun:
            self._stale_messages.ended(self.type, success=False)
        super().fail(error)

    def clean_up(self, now: float) -> None:
        self._stale_messages.held_back = True
        if self.begun:
            self.acknowledge(common.MavMissionResult.OPERATION_CANCELLED, now)

    def request(self, message: Message, now: float, priority: Priority | None = None) -> None:
        """Send a message that needs an answer, and wait for it."""
        self.send(message) if priority is None else self.send(message, priority)
        self.requested(now)

    def requested(self, now: float) -> None:
        """Record that a message that needs an answer is sent."""
        self.tries += 1
        self.attempts = max(self.attempts, self.tries)
        self.sent_at = now
        self._stale_messages.record(self.type, self.writes, now)
        # A single loss is common and does not show a longer round trip: the timeout doubles from the second
        # repetition on.
        self.timer = now + self._round_trip.timeout(max(self.tries - 1, 1))

    def answered(self, now: float) -> None:
        """Record the answer to the last message; a message sent once is a round-trip sample."""
        if self.tries == 1:
            self._round_trip.add_sample(now - self.sent_at)
        self.tries = 0

    def acknowledge(self, result: int, now: float) -> None:
        """Send MISSION_ACK."""
        target = self.target
        self._stale_messages.record(self.type, self.writes, now)
        self.send(
            common.MissionAck(
                target_system=target.system,
                target_component=target.component,
                type=result,
                mission_type=self.type,
            )
        )

    def refused(self, result: int, item: int | None = None, description: str = "") -> None:
        """Fail with the vehicle's MAV_MISSION_RESULT, and the item that it refers to."""
        answer = result_name(result) + ("" if item is None else f" at item {item}")
        answer += f" ({description})" if description else ""
        target = str(self.target)
        if result == common.MavMissionResult.OPERATION_CANCELLED:
            self.fail(RemoteCancelled(self.description, target, attempts=self.attempts, answer=answer))
            return
        error = MissionDenied(
            self.description, target, attempts=self.attempts, answer=answer, code=int(result)
        )
        error.item = item
        self.fail(error)

    def _open(self, now: float) -> None:
        self.begun, self.tries = True, 0
        self._ignores_first = self._stale_messages.held_back
        self.report_progress(now)
        self.open(now)


def result_name(result: int) -> str:
    """Return the name of a MAV_MISSION_RESULT."""
    try:
        return common.MavMissionResult(result).name
    except ValueError:
        return f"result {int(result)}"

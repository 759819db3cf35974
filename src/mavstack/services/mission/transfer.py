"""What uploading, downloading and clearing have in common on the asking side.

They go on one at a time toward one vehicle, whatever the type of the plan: PX4 has one state for all of them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

from mavstack.dialects import common
from mavstack.errors import MissionDenied, MissionTimeout, RemoteCancelled
from mavstack.services.mission.strays import SETTLE, Strays
from mavstack.services.operation import Operation
from mavstack.services.timing import RoundTrip

if TYPE_CHECKING:
    from mavstack.dialects import Message
    from mavstack.errors import MavstackError
    from mavstack.services.service import Priority
    from mavstack.wire import Packet

Result = TypeVar("Result")

#: How long a transfer waits for the vehicle to take one step forward.
IDLE_TIMEOUT = 10.0
#: How often a transfer begins again from its first message, because the vehicle lost its side of it.
MOST_ROUNDS = 4


class Transfer(Operation[Result]):
    """A step by step exchange about plans of one type."""

    timeout_error = MissionTimeout
    #: Whether it changes what the vehicle holds.
    writes = False

    def __init__(self, description: str, plan_type: int, timeout: float | None) -> None:
        super().__init__(description, timeout=timeout, idle_timeout=IDLE_TIMEOUT)
        self.type = int(plan_type)
        self.begun = False
        self.tries = 0  # of what was sent last
        self.sent_at = 0.0
        self._not_before = 0.0
        self._distrusts = False
        self._strays = Strays()
        self._round_trip = RoundTrip()

    def open(self, now: float) -> None:
        """Send the first message."""
        raise NotImplementedError

    def hear(self, packet: Packet, now: float) -> None:
        """Take a message about plans of this type."""
        raise NotImplementedError

    def silent(self, now: float) -> None:
        """Nothing came for as long as an answer usually takes."""
        raise NotImplementedError

    def join(self, strays: Strays, round_trip: RoundTrip) -> None:
        """Share what the client knows about its vehicle."""
        self._strays, self._round_trip = strays, round_trip

    def start(self, now: float) -> None:
        due = max(self._strays.gone_at(self.type, self.writes), self._not_before)
        if now >= due:
            self._open(now)
        else:
            self.begun, self.timer = False, due

    def receive(self, packet: Packet, now: float) -> None:
        kind = getattr(packet.message, "mission_type", None)
        if kind is None or self.type not in (kind, common.MavMissionType.ALL):
            return
        if not self.begun:
            self.start(now)  # it may be what was waited for
            return
        self._strays.seen(self.type, self.writes, now)
        if self._distrusts:
            self._strays.held_back = False
            self.pause(SETTLE, now)
        else:
            self.hear(packet, now)

    def pause(self, seconds: float, now: float) -> None:
        """Open anew so many seconds from now, and hear nothing until then."""
        self._not_before = now + seconds
        self.start(now)

    def handle_timeout(self, now: float) -> None:
        if self.begun:
            self.silent(now)
        else:
            self.start(now)

    def finish(self, result: Result) -> None:
        if not self.done:
            self._strays.ended(self.type, well=True)
        super().finish(result)

    def fail(self, error: MavstackError) -> None:
        if not self.done and self.begun:
            self._strays.ended(self.type, well=False)
        super().fail(error)

    def clean_up(self, now: float) -> None:
        self._strays.held_back = True
        if self.begun:
            self.acknowledge(common.MavMissionResult.OPERATION_CANCELLED, now)

    def ask(self, message: Message, now: float, priority: Priority | None = None) -> None:
        """Send what has to be answered, and wait for the answer."""
        self.send(message) if priority is None else self.send(message, priority)
        self.asked(now)

    def asked(self, now: float) -> None:
        """Something that has to be answered goes out."""
        self.tries += 1
        self.attempts = max(self.attempts, self.tries)
        self.sent_at = now
        self._strays.seen(self.type, self.writes, now)
        # One loss is usual and says nothing about the round trip: only from the second on is it doubled.
        self.timer = now + self._round_trip.timeout(max(self.tries - 1, 1))

    def answered(self, now: float) -> None:
        """What was asked last was answered; it is measured if it was asked once."""
        if self.tries == 1:
            self._round_trip.measured(now - self.sent_at)
        self.tries = 0

    def acknowledge(self, result: int, now: float) -> None:
        """Send MISSION_ACK."""
        target = self.target
        self._strays.seen(self.type, self.writes, now)
        self.send(
            common.MissionAck(
                target_system=target.system,
                target_component=target.component,
                type=result,
                mission_type=self.type,
            )
        )

    def refused(self, result: int, item: int | None = None) -> None:
        """End with what the vehicle answered."""
        answer = result_name(result) + ("" if item is None else f" at item {item}")
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
        self._distrusts = self._strays.held_back
        self.report_progress(now)
        self.open(now)


def result_name(result: int) -> str:
    """A MAV_MISSION_RESULT in a text for people."""
    try:
        return common.MavMissionResult(result).name
    except ValueError:
        return f"result {int(result)}"

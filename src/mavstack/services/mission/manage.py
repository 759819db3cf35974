"""Small operations on plans: clearing them, and setting the current item of the mission.

MAV_CMD_DO_SET_MISSION_CURRENT goes through the command service and is acknowledged. For the older
MISSION_SET_CURRENT, success is a MISSION_CURRENT with that number; failure is a STATUSTEXT without any
reference, so it shows as a timeout.
"""

from __future__ import annotations

from math import nan
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError, MissionTimeout
from mavstack.services.command import Command, CommandOperation
from mavstack.services.mission.plan import PLAN_TYPES, PlanType, name_of
from mavstack.services.mission.transfer import Transfer
from mavstack.services.operation import Operation
from mavstack.services.timing import RoundTrip

if TYPE_CHECKING:
    from mavstack.wire import Packet

_Result = common.MavMissionResult

SET_CURRENT_TIMEOUT = 5.0


class ClearPlan(Transfer[None]):
    """The clearing of the plan of one type, or of all.

    On a vehicle that does not support `PlanType.ALL` each type is cleared in turn.
    """

    writes = True

    def __init__(self, plan_type: int, *, timeout: float | None = None) -> None:
        if plan_type not in (*PLAN_TYPES, PlanType.ALL):
            raise InvalidArgumentError(
                f"plan_type must be one of PLAN_TYPES or PlanType.ALL, got {plan_type}"
            )
        super().__init__(f"clearing {name_of(plan_type)} on", plan_type, timeout)
        self._left = [int(plan_type)]

    def open(self, now: float) -> None:
        self._send_clear(now)

    def handle_silence(self, now: float) -> None:
        self._send_clear(now)

    def handle_message(self, packet: Packet, now: float) -> None:
        match packet.message:
            # The acknowledgement of a cleared plan has no id; one with an id is a late acknowledgement of an
            # upload.
            case common.MissionAck(type=result, mission_type=kind, opaque_id=0) if kind == self._left[0]:
                self._acknowledged(result, now)

    def clean_up(self, now: float) -> None:
        # Unlike after other transfers no acknowledgement is sent, because the vehicle keeps no state.
        self._stale_messages.held_back = True

    def _send_clear(self, now: float) -> None:
        target = self.target
        message = common.MissionClearAll(
            target_system=target.system, target_component=target.component, mission_type=self._left[0]
        )
        self.request(message, now)

    def _acknowledged(self, result: int, now: float) -> None:
        one_of_all = self.type == PlanType.ALL and self._left[0] != PlanType.ALL
        if result == _Result.UNSUPPORTED and self._left == [PlanType.ALL]:
            self._left += [int(kind) for kind in PLAN_TYPES]
        elif result != _Result.ACCEPTED and not (one_of_all and result == _Result.UNSUPPORTED):
            self.refused(result)
            return
        self.answered(now)
        self.report_progress(now)
        del self._left[0]
        if self._left:
            self._send_clear(now)
        else:
            self.finish(None)


class SetCurrentItem(Operation[int]):
    """MISSION_SET_CURRENT, repeated until MISSION_CURRENT confirms the number, which is the result."""

    timeout_error = MissionTimeout

    def __init__(self, seq: int, *, timeout: float | None = None) -> None:
        super().__init__(
            f"setting mission item {seq} as current on", timeout=timeout, idle_timeout=SET_CURRENT_TIMEOUT
        )
        self.seq = seq
        self._round_trip = RoundTrip(maximum=1.5)

    def start(self, now: float) -> None:
        self._transmit(now)

    def handle_timeout(self, now: float) -> None:
        self._transmit(now)

    def receive(self, packet: Packet, now: float) -> None:
        match packet.message:
            case common.MissionCurrent(seq=seq) if seq == self.seq:
                self.finish(seq)

    def _transmit(self, now: float) -> None:
        target = self.target
        self.attempts += 1
        self.timer = now + self._round_trip.timeout(self.attempts)
        self.send(
            common.MissionSetCurrent(
                target_system=target.system, target_component=target.component, seq=self.seq
            )
        )


def set_current_item(seq: int, *, restart: bool = False, timeout: float | None = None) -> CommandOperation:
    """Return MAV_CMD_DO_SET_MISSION_CURRENT as an operation for the target's `CommandClient.begin`.

    Args:
        seq: The item to continue at; -1 with `restart` keeps the current item.
        restart: Reset the mission, its jump counters included.
        timeout: Seconds for the whole operation; None sets no overall limit.
    """
    command = Command(
        common.MavCmd.DO_SET_MISSION_CURRENT, seq, 1.0 if restart else 0.0, nan, nan, nan, nan, nan
    )
    return CommandOperation(command, timeout=timeout)

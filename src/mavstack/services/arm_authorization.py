"""Arm authorisation: a vehicle asks another system, the authoriser, whether it may arm.

The vehicle sends MAV_CMD_ARM_AUTHORIZATION_REQUEST to the system of its parameter. The authoriser answers
ACCEPTED with the seconds for which the authorisation is valid in `result_param2`, or TEMPORARILY_REJECTED or
DENIED with a MAV_ARM_AUTH_DENIED_REASON in `progress` and its detail, such as the number of a wrong waypoint,
in `result_param2`. PX4 has the vehicle's side (COM_ARM_AUTH_REQ).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.services.addressing import Address, message_ids
from mavstack.services.service import Event, Service

if TYPE_CHECKING:
    from mavstack.services.command import CommandRequest, CommandServer
    from mavstack.wire import Packet

#: Seconds until an unanswered request is sent again.
RETRY_INTERVAL: Final = 0.3
_MAX_SECONDS: Final = 0xFFFF
_MAX_DETAIL: Final = 0x7FFFFFFF
_COMMAND: Final = common.MavCmd.ARM_AUTHORIZATION_REQUEST
_RESULT: Final = common.MavResult


@dataclass(frozen=True, slots=True)
class ArmApproval:
    """The vehicle may arm.

    Attributes:
        seconds: How long this is valid, 1 to 65535.
    """

    seconds: int = 60

    def __post_init__(self) -> None:
        if not 1 <= self.seconds <= _MAX_SECONDS:
            raise InvalidArgumentError(f"seconds must be from 1 to {_MAX_SECONDS}, got {self.seconds}")


@dataclass(frozen=True, slots=True)
class ArmRefusal:
    """The vehicle may not arm.

    Attributes:
        reason: A MAV_ARM_AUTH_DENIED_REASON.
        detail: More about the reason: with INVALID_WAYPOINT the number of the waypoint.
        temporarily: True if the vehicle may ask again soon.
    """

    reason: int = common.MavArmAuthDeniedReason.GENERIC
    detail: int = 0
    temporarily: bool = False

    def __post_init__(self) -> None:
        if not 0 <= self.reason <= 255 or not 0 <= self.detail <= _MAX_DETAIL:
            raise InvalidArgumentError("reason must be from 0 to 255, detail not negative")


@dataclass(frozen=True, slots=True)
class ArmAuthorizationAnswered(Event):
    """The authoriser answered; None: it did not answer in time."""

    answer: ArmApproval | ArmRefusal | None


class ArmAuthorizationClient(Service):
    """The vehicle's side: asks the authoriser; one request at a time."""

    handles = message_ids(common.CommandAck)

    def __init__(self, local: Address) -> None:
        super().__init__(local)
        self._authorizer = 0
        self._due: float | None = None
        self._ends = 0.0
        self._sent = 0

    @property
    def is_waiting(self) -> bool:
        """True while the authoriser has not answered."""
        return self._due is not None

    def request(self, authorizer: int, now: float, *, timeout: float) -> None:
        """Ask a system for authorisation; an event has the answer."""
        if self._due is None:
            self._authorizer, self._sent = authorizer, 0
            self._due, self._ends = now, now + timeout

    def receive(self, packet: Packet, now: float) -> None:
        match packet.message:
            case common.CommandAck() as ack if self._is_answer(ack, packet.system):
                if ack.result == _RESULT.IN_PROGRESS:
                    self._due = self._ends
                    return
                self._due = None
                self.emit(ArmAuthorizationAnswered(_answer_of(ack)))

    def next_timeout(self) -> float | None:
        return None if self._due is None else min(self._due, self._ends)

    def handle_timeout(self, now: float) -> None:
        if self._due is None or now < min(self._due, self._ends):
            return
        if now >= self._ends:
            self._due = None
            self.emit(ArmAuthorizationAnswered(None))
            return
        target = Address(self._authorizer, 0)
        command = common.CommandLong(
            *target, command=_COMMAND, confirmation=self._sent & 0xFF, param1=float(self.local.system)
        )
        self.send(command, target)
        self._sent += 1
        self._due = now + RETRY_INTERVAL

    def _is_answer(self, ack: common.CommandAck, system: int) -> bool:
        return self._due is not None and ack.command == _COMMAND and system == self._authorizer


def send_answer(commands: CommandServer, request: CommandRequest, answer: ArmApproval | ArmRefusal) -> None:
    """Acknowledge a request that is running, on the authoriser's side."""
    match answer:
        case ArmApproval(seconds=seconds):
            commands.complete(request, _RESULT.ACCEPTED, seconds)
        case ArmRefusal():
            result = _RESULT.TEMPORARILY_REJECTED if answer.temporarily else _RESULT.DENIED
            commands.complete(request, result, answer.detail, progress=answer.reason)


def _answer_of(ack: common.CommandAck) -> ArmApproval | ArmRefusal:
    if ack.result == _RESULT.ACCEPTED:
        return ArmApproval(min(max(ack.result_param2, 1), _MAX_SECONDS))
    is_temporary = ack.result == _RESULT.TEMPORARILY_REJECTED
    return ArmRefusal(int(ack.progress), max(ack.result_param2, 0), is_temporary)

"""The rate of a message: setting it, and reading it. Both run on the target's `CommandClient`.

MAV_CMD_SET_MESSAGE_INTERVAL comes first. If it is answered UNSUPPORTED, REQUEST_DATA_STREAM is sent for the
message's whole group, which is not acknowledged: its success shows when the message, or a DATA_STREAM,
arrives. Turning a group off shows by nothing, so it is sent several times.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from mavstack.dialects import common
from mavstack.errors import CommandDenied, MessageTimeout
from mavstack.services.addressing import message_ids
from mavstack.services.command import Command, CommandOperation
from mavstack.services.message_request.client import RequestMessage
from mavstack.services.message_request.interval import (
    DEFAULT,
    OFF,
    Interval,
    group_of,
    message_id_of,
    name_of,
)
from mavstack.services.operation import Operation
from mavstack.services.procedure import Procedure

if TYPE_CHECKING:
    from collections.abc import Generator

    from mavstack.dialects import Message
    from mavstack.wire import Packet

STREAM_ATTEMPTS = 5
OFF_ATTEMPTS = 3
#: The range of REQUEST_DATA_STREAM, hertz.
MIN_STREAM_RATE = 1
MAX_STREAM_RATE = 0xFFFF


@dataclass(frozen=True, slots=True)
class RateSet:
    """The result of setting a rate; `whole_group` is the MAV_DATA_STREAM that was set, on old autopilots."""

    interval: Interval
    whole_group: int | None = None


class SetMessageInterval(Procedure[RateSet]):
    """The setting of a message's interval: a rate, the default rate, or off."""

    timeout_error = MessageTimeout

    def __init__(
        self, message: type[Message] | int, interval: Interval, *, timeout: float | None = None
    ) -> None:
        super().__init__(f"setting the interval of {name_of(message)} on", timeout=timeout, idle_timeout=60.0)
        self._message_id = message_id_of(message)
        self._interval = interval

    def steps(self) -> Generator[Operation[Any], Any, RateSet]:
        """Send the command; if it is unsupported, request the data stream."""
        microseconds = float(self._interval.microseconds)
        command = Command(common.MavCmd.SET_MESSAGE_INTERVAL, float(self._message_id), microseconds)
        try:
            yield CommandOperation(command)
        except CommandDenied as denied:
            group = group_of(self._message_id)
            if denied.code != common.MavResult.UNSUPPORTED or group is None or self._interval == DEFAULT:
                raise
            yield _RequestDataStream(group, self._message_id, self._interval)
            return RateSet(self._interval, group)
        return RateSet(self._interval)


class GetMessageInterval(Procedure[Interval]):
    """The reading of a message's interval; `DEFAULT` (0) if the target cannot send the message."""

    timeout_error = MessageTimeout

    def __init__(self, message: type[Message] | int, *, timeout: float | None = None) -> None:
        super().__init__(f"reading the interval of {name_of(message)} of", timeout=timeout, idle_timeout=60.0)
        self._message_id = message_id_of(message)

    def steps(self) -> Generator[Operation[Any], Any, Interval]:
        """Request MESSAGE_INTERVAL."""
        answer: common.MessageInterval = yield RequestMessage(
            common.MessageInterval,
            (float(self._message_id),),
            match=lambda message: message.message_id == self._message_id,
        )
        return Interval(max(answer.interval_us, OFF.microseconds))


class _RequestDataStream(Operation[None]):
    """The request of a data stream."""

    timeout_error = MessageTimeout

    def __init__(self, group: int, message_id: int, interval: Interval) -> None:
        super().__init__(f"requesting data stream {group} from", idle_timeout=60.0)
        self._group, self._message_id = group, message_id
        self._rate = min(max(round(interval.rate), MIN_STREAM_RATE), MAX_STREAM_RATE)
        self._on = interval != OFF
        self.handles = message_ids(common.DataStream) | {message_id}

    def start(self, now: float) -> None:
        self._send_request(now)

    def receive(self, packet: Packet, now: float) -> None:
        match packet.message:
            case common.DataStream(stream_id=self._group, on_off=on) if bool(on) == self._on:
                self.finish(None)
            case _ if self._on and packet.message_id == self._message_id:
                self.finish(None)

    def handle_timeout(self, now: float) -> None:
        if self.attempts < (STREAM_ATTEMPTS if self._on else OFF_ATTEMPTS):
            self._send_request(now)
        elif self._on:
            self.time_out(now)
        else:
            self.finish(None)

    def _send_request(self, now: float) -> None:
        self.attempts += 1
        self.timer = now + (1.0 + 2.0 / self._rate if self._on else 0.5)
        self.send(
            common.RequestDataStream(
                target_system=self.target.system,
                target_component=self.target.component,
                req_stream_id=self._group,
                req_message_rate=self._rate,
                start_stop=int(self._on),
            )
        )

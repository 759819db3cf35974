"""The operations of a `ParameterClient`: getting, setting and downloading parameters, and their hash.

A set is answered by the PARAM_VALUE with the new value. Some components answer only a change, so every second
attempt also requests the value. A value from another source, or one that was in transit before, is no
refusal, nor is one that was requested, since the new value may have been lost: only the third wrong answer
is. For an unknown name some components send nothing, some a PARAM_ERROR, and PX4 before that message a
STATUSTEXT.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar, cast

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError, LocalProtocolError
from mavstack.services.addressing import message_ids
from mavstack.services.parameters.hashing import HASH_NAME, hash_of
from mavstack.services.parameters.listing import Listing, denied
from mavstack.services.parameters.retrying_request import MAX_REFUSALS, RetryingRequest, SetRequest
from mavstack.services.parameters.value import (
    Encoding,
    Parameter,
    Value,
    as_type,
    decode,
    encode,
    is_integer,
    same,
    shortest,
    survives,
    type_name,
    with_field,
)

if TYPE_CHECKING:
    from mavstack.dialects import Message
    from mavstack.services.parameters.cache import ReceivedParameter, Snapshot
    from mavstack.services.parameters.client import ParameterClient
    from mavstack.services.timing import RoundTrip
    from mavstack.wire import Packet

Result = TypeVar("Result")

BY_NAME = -1
UNKNOWN_TEXT = "unknown param: "
UNKNOWN_INDEX_TEXT = "unknown param ID: "


class ParameterOperation(RetryingRequest[Result]):
    """The base of `ParameterClient` operations that repeat one request until it is answered."""

    handles = message_ids(common.Statustext)

    @property
    def parameters(self) -> ParameterClient:
        """The client that runs the operation."""
        return cast("ParameterClient", self.client)

    @property
    def round_trip(self) -> RoundTrip:
        return self.parameters.round_trip

    def receive(self, packet: Packet, now: float) -> None:
        match packet.message:
            case common.ParamError() as error:
                if self.is_about_this(error):
                    self.answered(now)
                    self.fail(denied(self, int(error.error)))
            case common.ParamValue() as message:
                self.receive_value(message, now)
            case common.Statustext(text=text) if text.endswith(self.unknown_text()):
                self.fail(denied(self, common.MavParamError.DOES_NOT_EXIST))

    def unknown_text(self) -> str:
        """Return the end of the status text that reports an unknown parameter."""
        return UNKNOWN_TEXT + HASH_NAME

    def is_about_this(self, error: common.ParamError) -> bool:
        """Return whether a PARAM_ERROR refers to this operation."""
        return False

    def receive_value(self, message: common.ParamValue, now: float) -> None:
        """Handle a PARAM_VALUE of the target."""


class GetParameter(ParameterOperation[Parameter]):
    """The request of one parameter by name or index."""

    def __init__(self, which: str | int, *, timeout: float | None = None) -> None:
        super().__init__(f"reading parameter {which} of", timeout=timeout)
        self.which = which

    def send_request(self) -> None:
        self.send(read_request(self.target.system, self.target.component, self.which))

    def unknown_text(self) -> str:
        return (
            UNKNOWN_TEXT + self.which if isinstance(self.which, str) else f"{UNKNOWN_INDEX_TEXT}{self.which}"
        )

    def is_about_this(self, error: common.ParamError) -> bool:
        return concerns(self.which, error.param_id, error.param_index)

    def receive_value(self, message: common.ParamValue, now: float) -> None:
        received = self.parameters.received
        if received is None or received.reordered:
            return
        if self.which in (received.parameter.name, received.parameter.index):
            self.answered(now)
            self.finish(received.parameter)


class SetParameter(SetRequest[Parameter], ParameterOperation[Parameter]):
    """The setting of one parameter, confirmed by its value."""

    def __init__(self, name: str, value: Value, kind: int | None, *, timeout: float | None = None) -> None:
        super().__init__(name, kind, shortest(value), timeout=timeout)
        self._requested = value
        self._wanted: Value | None = None
        self._other_value: Parameter | None = None
        self._requests_value = False

    def known_type(self) -> int | None:
        known = self.parameters.parameters.get(self.name)
        return None if known is None else known.type

    def type_request(self) -> GetParameter:
        return GetParameter(self.name)

    def handle_timeout(self, now: float) -> None:
        if self._other_value is not None:
            self._silent = -1
            self._refusals += 0 if self._requests_value else 1
            if self._refusals >= MAX_REFUSALS:
                self.fail(denied(self, 0, f"the value stayed {self._other_value.text}"))
                return
        super().handle_timeout(now)

    def send_request(self) -> None:
        target, kind = self.target, self._kind or 0
        message = common.ParamSet(
            target_system=target.system,
            target_component=target.component,
            param_id=self.name,
            param_type=kind,
        )
        wanted = self._requested if self._wanted is None else self._wanted
        self.send(with_field(message, encode(wanted, kind, self.parameters.encoding)))
        self._requests_value = self.attempts % 2 == 1
        if self._requests_value:
            self.send(read_request(target.system, target.component, self.name))
        self._other_value = None

    def unknown_text(self) -> str:
        return UNKNOWN_TEXT + self.name

    def is_about_this(self, error: common.ParamError) -> bool:
        return self._wanted is not None and concerns(self.name, error.param_id, error.param_index)

    def receive_value(self, message: common.ParamValue, now: float) -> None:
        received = self.parameters.received
        if (
            received is None
            or received.reordered
            or received.parameter.name != self.name
            or self._wanted is None
        ):
            return
        # the type field of a cast value is not reliable
        cast_value = self.parameters.encoding is Encoding.C_CAST
        right_type = cast_value or received.parameter.type == self._kind
        if right_type and same(received.parameter.value, self._wanted):
            self.answered(now)
            self.finish(received.parameter)
        else:
            self._other_value = received.parameter

    def send_value(self, now: float) -> None:
        kind, encoding = self._kind or 0, self.parameters.encoding
        try:
            value = as_type(self.name, self._requested, kind)
        except LocalProtocolError as error:
            self.fail(error)
            return
        self._wanted = decode(encode(value, kind, encoding), kind, encoding)
        if not survives(value, kind, encoding):
            if is_integer(kind):
                self.fail(
                    InvalidArgumentError(
                        f"{self.name} cannot be set to {self._requested}: "
                        f"a {type_name(kind)} is sent as a float32, and would become {self._wanted}"
                    )
                )
                return
            self.parameters.report_rounded(self.name, self._requested, self._wanted)
        self.transmit(now)


class ReadHash(ParameterOperation[int]):
    """The request of the hash of all parameters."""

    def __init__(self, *, timeout: float | None = None) -> None:
        super().__init__("reading the parameter hash of", timeout=timeout)

    def send_request(self) -> None:
        self.send(read_request(self.target.system, self.target.component, HASH_NAME))

    def is_about_this(self, error: common.ParamError) -> bool:
        return concerns(HASH_NAME, error.param_id, error.param_index)

    def receive_value(self, message: common.ParamValue, now: float) -> None:
        remote = self.parameters.remote_hash
        if message.param_id == HASH_NAME and remote is not None:
            self.answered(now)
            self.finish(remote)


class DownloadParameters(Listing["dict[str, Parameter]"]):
    """The download of all parameters, unless their hash is that of a known set."""

    handles = message_ids(common.ParamError)

    def __init__(
        self,
        round_trip: RoundTrip,
        known: Snapshot | None = None,
        *,
        timeout: float | None = None,
        idle_timeout: float = 10.0,
    ) -> None:
        super().__init__(
            "downloading the parameters of", round_trip, timeout=timeout, idle_timeout=idle_timeout
        )
        self._known = known
        self._hashes: set[int] = set()
        if known is not None:
            self._hashes.add(hash_of(known.parameters))
            self._hashes |= set() if known.hash is None else {known.hash}

    @property
    def parameters(self) -> ParameterClient:
        """The client that runs the operation."""
        return cast("ParameterClient", self.client)

    def list_request(self) -> Message:
        target = self.target
        return common.ParamRequestList(target_system=target.system, target_component=target.component)

    def entry_request(self, index: int) -> Message:
        return read_request(self.target.system, self.target.component, index)

    def start(self, now: float) -> None:
        if self._known is not None:
            self.send(read_request(self.target.system, self.target.component, HASH_NAME))
        super().start(now)

    def receive(self, packet: Packet, now: float) -> None:
        match packet.message:
            case common.ParamError(param_index=index, error=error) if index >= 0:
                self.entry_refused(index, int(error), now)
            case common.ParamValue(param_id=name) if name == HASH_NAME:
                self._receive_hash(now)
            case common.ParamValue():
                received = self.parameters.received
                if received is not None and received.parameter.index is not None:
                    self._receive_entry(received, now)

    def _receive_entry(self, received: ReceivedParameter, now: float) -> None:
        parameter = received.parameter
        self.receive_entry(
            parameter.index or 0, received.count, parameter.name, now, reordered=received.reordered
        )

    def finish_list(self, names: list[str], now: float) -> None:
        client = self.parameters
        client.set_complete(names, client.remote_hash)
        self.finish(dict(client.parameters))

    def clean_up(self, now: float) -> None:
        """Stop PX4's list, which ends when the hash is set; other autopilots have no such name."""
        if self.parameters.remote_hash is not None:
            self._stop_list()

    def _receive_hash(self, now: float) -> None:
        remote = self.parameters.remote_hash
        if self._known is not None and remote is not None and remote in self._hashes:
            self._stop_list()
            self.parameters.load_snapshot(self._known, remote, now)
            self.finish(dict(self.parameters.parameters))

    def _stop_list(self) -> None:
        target = self.target
        self.send(
            common.ParamSet(
                target_system=target.system,
                target_component=target.component,
                param_id=HASH_NAME,
                param_type=common.MavParamType.UINT32,
            )
        )


def read_request(system: int, component: int, which: str | int) -> common.ParamRequestRead:
    """Return the message that requests one parameter by name or index."""
    by_name = isinstance(which, str)
    return common.ParamRequestRead(
        target_system=system,
        target_component=component,
        param_id=which if isinstance(which, str) else "",
        param_index=BY_NAME if by_name else int(which),
    )


def concerns(which: str | int, name: str, index: int) -> bool:
    """Return whether a PARAM_ERROR, which has a valid name or a valid index, refers to this request."""
    return index == which if isinstance(which, int) else index < 0 and name == which

"""The operations of an `ExtendedParameterClient`: getting, setting and downloading; see `client`."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar, cast

from mavstack.dialects import common
from mavstack.errors import LocalProtocolError, ParameterDenied
from mavstack.services.extended_parameters.value import (
    ExtendedParameter,
    ExtendedValue,
    encode,
    is_known,
    with_field,
)
from mavstack.services.parameters.listing import Listing
from mavstack.services.parameters.retrying_request import MAX_REFUSALS, RetryingRequest, SetRequest

if TYPE_CHECKING:
    from mavstack.dialects import Message
    from mavstack.services.extended_parameters.cache import ExtendedParameterCache, ReceivedExtendedParameter
    from mavstack.services.timing import RoundTrip
    from mavstack.wire import Packet

Result = TypeVar("Result")

#: Seconds between two requests of the value while it is being set.
PROGRESS_INTERVAL = 2.0


class ExtendedOperation(RetryingRequest[Result]):
    """The base of `ExtendedParameterClient` operations that repeat one request until it is answered."""

    @property
    def parameters(self) -> ExtendedParameterCache:
        """The client that runs the operation."""
        return cast("ExtendedParameterCache", self.client)

    @property
    def round_trip(self) -> RoundTrip:
        return self.parameters.round_trip

    def receive(self, packet: Packet, now: float) -> None:
        received = self.parameters.received
        if received is not None and not received.reordered:
            self.value_came(received, now)

    def value_came(self, received: ReceivedExtendedParameter, now: float) -> None:
        """Handle a value or an acknowledgement of the target."""


class GetExtendedParameter(ExtendedOperation[ExtendedParameter]):
    """The request of one parameter by name or index."""

    def __init__(self, which: str | int, *, timeout: float | None = None) -> None:
        super().__init__(f"reading extended parameter {which} of", timeout=timeout)
        self.which = which

    def send_request(self) -> None:
        self.send(read_request(self.target.system, self.target.component, self.which))

    def value_came(self, received: ReceivedExtendedParameter, now: float) -> None:
        if received.result is None and self.which in (received.parameter.name, received.parameter.index):
            self.answered(now)
            self.finish(received.parameter)


class SetExtendedParameter(SetRequest[ExtendedParameter], ExtendedOperation[ExtendedParameter]):
    """The setting of one parameter, which may take a while (IN_PROGRESS)."""

    def __init__(self, name: str, value: ExtendedValue, kind: int | None, *, timeout: float | None) -> None:
        super().__init__(name, kind, repr(value), timeout=timeout)
        self._asked = value
        self._wanted: bytes | None = None
        self._kept: ExtendedParameter | None = None
        self._in_progress = False

    def known_type(self) -> int | None:
        known = self.parameters.parameters.get(self.name)
        return None if known is None else known.type

    def type_request(self) -> GetExtendedParameter:
        return GetExtendedParameter(self.name)

    def handle_timeout(self, now: float) -> None:
        if self._in_progress:
            self.send(read_request(self.target.system, self.target.component, self.name))
            self.timer = now + PROGRESS_INTERVAL
            return
        if self._kept is not None:
            self._refusals += 1
            if self._refusals >= MAX_REFUSALS:
                self._deny(common.ParamAck.FAILED, f"it became {self._kept.value!r}")
                return
        super().handle_timeout(now)

    def time_out(self, now: float, answer: str = "no answer") -> None:
        super().time_out(now, "started, then no further answer" if self._in_progress else answer)

    def send_request(self) -> None:
        message = common.ParamExtSet(
            target_system=self.target.system,
            target_component=self.target.component,
            param_id=self.name,
            param_type=self._kind or 0,
        )
        self.send(with_field(message, self._wanted or b""))
        self._kept = None

    def value_came(self, received: ReceivedExtendedParameter, now: float) -> None:
        if received.parameter.name != self.name or self._wanted is None:
            return
        if received.result is None:
            if self._in_progress and self._is_wanted(received.parameter):
                self.finish(received.parameter)
        elif received.result == common.ParamAck.IN_PROGRESS:
            self._in_progress = True
            self.report_progress(now)
            self.timer = now + PROGRESS_INTERVAL
        elif received.result != common.ParamAck.ACCEPTED:
            self.answered(now)
            self._deny(received.result)
        elif self._is_wanted(received.parameter):
            self.answered(now)
            self.finish(self.parameters.parameters.get(self.name, received.parameter))
        else:
            self._kept = received.parameter

    def _is_wanted(self, parameter: ExtendedParameter) -> bool:
        return (
            parameter.type == self._kind
            and is_known(parameter.type)
            and encode(parameter.value, parameter.type) == self._wanted
        )

    def send_value(self, now: float) -> None:
        try:
            self._wanted = encode(self._asked, self._kind or 0)
        except LocalProtocolError as error:
            self.fail(error)
            return
        self.transmit(now)

    def _deny(self, code: int, answer: str = "") -> None:
        known = code in {entry.value for entry in common.ParamAck}
        reason = answer or (common.ParamAck(code).name if known else f"result {code}")
        self.fail(
            ParameterDenied(
                self.description, str(self.target), attempts=self.attempts, answer=reason, code=int(code)
            )
        )


class DownloadExtendedParameters(Listing["dict[str, ExtendedParameter]"]):
    """The download of all extended parameters."""

    def __init__(
        self, round_trip: RoundTrip, *, timeout: float | None = None, idle_timeout: float = 10.0
    ) -> None:
        super().__init__(
            "downloading the extended parameters of", round_trip, timeout=timeout, idle_timeout=idle_timeout
        )

    @property
    def parameters(self) -> ExtendedParameterCache:
        """The client that runs the operation."""
        return cast("ExtendedParameterCache", self.client)

    def list_request(self) -> Message:
        target = self.target
        return common.ParamExtRequestList(target_system=target.system, target_component=target.component)

    def entry_request(self, index: int) -> Message:
        return read_request(self.target.system, self.target.component, index)

    def receive(self, packet: Packet, now: float) -> None:
        received = self.parameters.received
        if received is not None and received.result is None and received.parameter.index is not None:
            parameter = received.parameter
            self.receive_entry(
                parameter.index or 0, received.count, parameter.name, now, reordered=received.reordered
            )

    def finish_list(self, names: list[str], now: float) -> None:
        self.parameters.set_complete(names)
        self.finish(dict(self.parameters.parameters))


def read_request(system: int, component: int, which: str | int) -> common.ParamExtRequestRead:
    """Return the message that requests one parameter by name or index."""
    return common.ParamExtRequestRead(
        target_system=system,
        target_component=component,
        param_id=which if isinstance(which, str) else "",
        param_index=-1 if isinstance(which, str) else which,
    )

"""The client of the extended parameters of one component (guide: extended parameter protocol).

    set ── ack ACCEPTED with the new value ──► result
     │  ├── ack IN_PROGRESS ──► running: the value is requested at an interval ── it is new ──► result
     │  │                          └── silence ──► ParameterTimeout
     │  ├── ack FAILED, VALUE_UNSUPPORTED ──► ParameterDenied
     │  └── ack ACCEPTED with another value ──► another client's, or the third time: ParameterDenied
     └── silence ──► repeated ──► ParameterTimeout

Acknowledgements name only the parameter; so a client runs one set of a parameter at a time.
"""

from __future__ import annotations

from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.services.addressing import Address, message_ids
from mavstack.services.extended_parameters.cache import ReceivedExtendedParameter
from mavstack.services.extended_parameters.operations import (
    DownloadExtendedParameters,
    GetExtendedParameter,
    SetExtendedParameter,
)
from mavstack.services.extended_parameters.value import (
    ExtendedParameter,
    ExtendedValue,
    decode,
    encode,
    field_of,
    read_value,
)
from mavstack.services.operation import Client, Operation
from mavstack.services.parameters.packed import MAX_PARAMETERS
from mavstack.services.parameters.reorder_filter import ReorderFilter
from mavstack.services.parameters.value import name_field
from mavstack.services.service import Event
from mavstack.services.timing import RoundTrip

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.wire import Packet


@dataclass(frozen=True, slots=True)
class ExtendedParameterChanged(Event):
    """An extended parameter was received for the first time (`previous` is None), or with another value."""

    parameter: ExtendedParameter
    previous: ExtendedParameter | None


class ExtendedParameterClient(Client):
    """The extended parameter client of one component."""

    handles = message_ids(common.ParamExtValue, common.ParamExtAck)

    def __init__(self, local: Address, target: Address) -> None:
        if not target.system or not target.component:
            raise InvalidArgumentError(f"the target of parameters must be one component, got {target}")
        super().__init__(local, target)
        self.round_trip = RoundTrip(initial=1.0, minimum=0.05, maximum=2.0)
        #: The parameter of the packet that is being received; the operations read it.
        self.received: ReceivedExtendedParameter | None = None
        self._parameters: dict[str, ExtendedParameter] = {}
        self._reorder_filter = ReorderFilter()
        self._complete = False

    @property
    def parameters(self) -> Mapping[str, ExtendedParameter]:
        """All received extended parameters, by name."""
        return MappingProxyType(self._parameters)

    @property
    def complete(self) -> bool:
        """True if the complete set was downloaded."""
        return self._complete

    def clear_cache(self, now: float) -> None:
        """Discard all parameters, because the component rebooted; a running download restarts."""
        self._parameters, self._complete = {}, False  # a new mapping, because callers may hold the old one
        for operation in self._running:
            if isinstance(operation, DownloadExtendedParameters):
                operation.restart_download(now)

    def get(self, which: str | int, now: float, *, timeout: float | None = None) -> GetExtendedParameter:
        """Request one parameter, by name or index; the result is the `ExtendedParameter`."""
        if isinstance(which, str):
            name_field(which)
        elif not 0 <= which < 32768:
            raise InvalidArgumentError(f"a parameter index must be from 0 to 32767, got {which}")
        return self.begin(GetExtendedParameter(which, timeout=timeout), now)

    def set(
        self,
        name: str,
        value: ExtendedValue,
        now: float,
        *,
        kind: int | None = None,
        timeout: float | None = None,
    ) -> SetExtendedParameter:
        """Set a parameter; the result is the `ExtendedParameter` with its new value.

        `kind` is its MAV_PARAM_EXT_TYPE; None: as received from the component, which is asked if necessary.
        """
        if kind is not None:
            encode(value, kind)
        return self.begin(SetExtendedParameter(name_field(name), value, kind, timeout=timeout), now)

    def download(
        self, now: float, *, timeout: float | None = None, idle_timeout: float = 10.0
    ) -> DownloadExtendedParameters:
        """Download the complete set; the result are the parameters by name, in the order of the table."""
        return self.begin(
            DownloadExtendedParameters(self.round_trip, timeout=timeout, idle_timeout=idle_timeout), now
        )

    def conflicts(self, new: Operation[Any], running: Operation[Any]) -> bool:
        if isinstance(new, SetExtendedParameter):
            return isinstance(running, SetExtendedParameter) and new.name == running.name
        return isinstance(new, DownloadExtendedParameters) and isinstance(running, DownloadExtendedParameters)

    def observe(self, packet: Packet, now: float) -> None:
        self.received = None
        match packet.message:
            case common.ParamExtValue(param_id=name) as message if name:
                reordered = self._reorder_filter.is_reordered(packet.sequence, now)
                parameter = read_value(message)
                self.received = ReceivedExtendedParameter(parameter, message.param_count, None, reordered)
                if not reordered or name not in self._parameters:
                    self._learn(parameter)
            case common.ParamExtAck(param_id=name) as message if name:
                reordered = self._reorder_filter.is_reordered(packet.sequence, now)
                kind = int(message.param_type)
                parameter = ExtendedParameter(name, decode(field_of(message), kind), kind)
                self.received = ReceivedExtendedParameter(parameter, 0, int(message.param_result), reordered)
                if message.param_result == common.ParamAck.ACCEPTED and not reordered:
                    self._learn(parameter)

    def set_complete(self, names: list[str]) -> None:
        """Record that these are all parameters, in their order; others are removed."""
        known = self._parameters
        self._parameters = {name: known[name] for name in names if name in known}
        self._complete = True

    def _learn(self, parameter: ExtendedParameter) -> None:
        name = parameter.name
        previous = self._parameters.get(name)
        if previous is None and len(self._parameters) >= MAX_PARAMETERS:
            return
        if parameter.index is None and previous is not None:
            parameter = ExtendedParameter(name, parameter.value, parameter.type, previous.index)
        self._parameters[name] = parameter
        if previous is None or repr(previous) != repr(parameter):
            self.emit(ExtendedParameterChanged(parameter, previous))

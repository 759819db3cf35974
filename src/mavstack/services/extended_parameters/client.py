"""Reading and setting the extended parameters of one component (guide: extended parameter protocol).

    set ── ack ACCEPTED with our value ──► result
     │  ├── ack IN_PROGRESS ──► running: the value is asked for now and then ── it is ours ──► result
     │  │                          └── silence ──► ParameterTimeout
     │  ├── ack FAILED, VALUE_UNSUPPORTED ──► ParameterDenied
     │  └── ack ACCEPTED with another value ──► another client's, or the third time: ParameterDenied
     └── silence ──► sent again ──► ParameterTimeout

Acknowledgements name the parameter alone; one client therefore sets one parameter once at a time.
"""

from __future__ import annotations

from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.services.addressing import Address, message_ids
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
    """An extended parameter was told for the first time (`previous` is None), or with another value."""

    parameter: ExtendedParameter
    previous: ExtendedParameter | None


@dataclass(frozen=True, slots=True)
class HeardExtended:
    """A PARAM_EXT_VALUE or PARAM_EXT_ACK: `result` is None in the former, `count` 0 in the latter."""

    parameter: ExtendedParameter
    count: int
    result: int | None
    overtaken: bool


class ExtendedParameterClient(Client):
    """The extended parameters of one component."""

    handles = message_ids(common.ParamExtValue, common.ParamExtAck)

    def __init__(self, local: Address, target: Address) -> None:
        if not target.system or not target.component:
            raise InvalidArgumentError(f"parameters belong to one component, and {target} is not one")
        super().__init__(local, target)
        self.round_trip = RoundTrip(initial=1.0, minimum=0.05, maximum=3.0)
        #: What the packet under way told; operations look here.
        self.heard: HeardExtended | None = None
        self._parameters: dict[str, ExtendedParameter] = {}
        self._reorder_filter = ReorderFilter()
        self._complete = False

    @property
    def parameters(self) -> Mapping[str, ExtendedParameter]:
        """All extended parameters heard of, by name."""
        return MappingProxyType(self._parameters)

    @property
    def complete(self) -> bool:
        """Whether the whole set was fetched."""
        return self._complete

    def clear_cache(self, now: float) -> None:
        """The component started anew: forget its parameters; a listing that is under way begins anew."""
        self._parameters, self._complete = {}, False  # who was given the old ones keeps them
        for operation in self._running:
            if isinstance(operation, DownloadExtendedParameters):
                operation.begin_anew(now)

    def read(self, which: str | int, now: float, *, timeout: float | None = None) -> GetExtendedParameter:
        """Ask for one parameter, by name or index; its result is the `ExtendedParameter`."""
        if isinstance(which, str):
            name_field(which)
        elif not 0 <= which < 32768:
            raise InvalidArgumentError(f"no parameter can be asked for by index {which}")
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
        """Set a parameter; its result is the `ExtendedParameter` as it is now.

        The type is that which the component told; if it told none yet, and `kind` gives none, it is asked.
        """
        if kind is not None:
            encode(value, kind)
        return self.begin(SetExtendedParameter(name_field(name), value, kind, timeout=timeout), now)

    def download(
        self, now: float, *, timeout: float | None = None, idle_timeout: float = 10.0
    ) -> DownloadExtendedParameters:
        """Fetch the whole set; its result are the parameters by name, in the order of their table."""
        return self.begin(
            DownloadExtendedParameters(self.round_trip, timeout=timeout, idle_timeout=idle_timeout), now
        )

    def conflicts(self, new: Operation[Any], running: Operation[Any]) -> bool:
        if isinstance(new, SetExtendedParameter):
            return isinstance(running, SetExtendedParameter) and new.name == running.name
        return isinstance(new, DownloadExtendedParameters) and isinstance(running, DownloadExtendedParameters)

    def observe(self, packet: Packet, now: float) -> None:
        self.heard = None
        match packet.message:
            case common.ParamExtValue(param_id=name) as message if name:
                overtaken = self._reorder_filter.is_overtaken(packet.sequence, now)
                parameter = read_value(message)
                self.heard = HeardExtended(parameter, message.param_count, None, overtaken)
                if not overtaken or name not in self._parameters:
                    self._learn(parameter)
            case common.ParamExtAck(param_id=name) as message if name:
                overtaken = self._reorder_filter.is_overtaken(packet.sequence, now)
                kind = int(message.param_type)
                parameter = ExtendedParameter(name, decode(field_of(message), kind), kind)
                self.heard = HeardExtended(parameter, 0, int(message.param_result), overtaken)
                if message.param_result == common.ParamAck.ACCEPTED and not overtaken:
                    self._learn(parameter)

    def now_whole(self, names: list[str]) -> None:
        """These are all parameters there are, in their order; others are gone."""
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

"""Reading and setting the parameters of one component (guide: parameter protocol).

`ParameterClient.parameters` is what is known of them, kept up by every PARAM_VALUE that the component sends,
whoever asked for it; each change is told as `ParameterChanged`. How values are to be read follows from the
component (`encoding_of`); a client that is told otherwise later forgets what it read.
"""

from __future__ import annotations

from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.services.addressing import Address, message_ids
from mavstack.services.operation import Client, Operation
from mavstack.services.parameters.hashing import HASH_NAME
from mavstack.services.parameters.operations import DownloadParameters, GetParameter, ReadHash, SetParameter
from mavstack.services.parameters.packed import MAX_PARAMETERS, PackedFile, unpack
from mavstack.services.parameters.reorder_filter import ReorderFilter
from mavstack.services.parameters.value import (
    Encoding,
    Parameter,
    Value,
    field_of,
    name_field,
    read_value,
    same,
)
from mavstack.services.service import Event
from mavstack.services.timing import RoundTrip

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.wire import Packet


@dataclass(frozen=True, slots=True)
class ParameterChanged(Event):
    """A parameter was told for the first time (`previous` is None), or with another value."""

    parameter: Parameter
    previous: Parameter | None


@dataclass(frozen=True, slots=True)
class ParameterRounded(Event):
    """A value that was to be set lost digits on its way: `asked` became `sent`."""

    name: str
    asked: Value
    sent: Value


@dataclass(frozen=True, slots=True)
class Snapshot:
    """A whole set in the order of its table, and the hash that the component told for it, if it did."""

    parameters: tuple[Parameter, ...]
    hash: int | None = None


@dataclass(frozen=True, slots=True)
class Heard:
    """A PARAM_VALUE: `count` parameters in all; `overtaken` if newer ones came before it."""

    parameter: Parameter
    count: int
    overtaken: bool


class ParameterClient(Client):
    """The parameters of one component."""

    handles = message_ids(common.ParamValue, common.ParamError)

    def __init__(self, local: Address, target: Address, encoding: Encoding = Encoding.BYTEWISE) -> None:
        if not target.system or not target.component:
            raise InvalidArgumentError(f"parameters belong to one component, and {target} is not one")
        super().__init__(local, target)
        self.round_trip = RoundTrip(initial=1.0, minimum=0.05, maximum=3.0)
        #: What the packet under way told; operations look here.
        self.heard: Heard | None = None
        self.told_hash: int | None = None
        self.defaults: dict[str, Value] = {}
        self._encoding = encoding
        self._parameters: dict[str, Parameter] = {}
        self._told_at: dict[str, float] = {}
        self._reorder_filter = ReorderFilter()
        self._complete = False

    # What is known

    @property
    def parameters(self) -> Mapping[str, Parameter]:
        """All parameters heard of, by name."""
        return MappingProxyType(self._parameters)

    @property
    def complete(self) -> bool:
        """Whether the whole set was fetched."""
        return self._complete

    @property
    def encoding(self) -> Encoding:
        """How values are read; another one forgets what was read."""
        return self._encoding

    @encoding.setter
    def encoding(self, encoding: Encoding) -> None:
        if encoding is not self._encoding:
            self._encoding = encoding
            self._clear()

    def clear_cache(self, now: float) -> None:
        """The component started anew: forget its parameters; a listing that is under way begins anew."""
        self._clear()
        for operation in self._running:
            if isinstance(operation, DownloadParameters):
                operation.begin_anew(now)

    def _clear(self) -> None:
        self._parameters, self._told_at = {}, {}  # who was given the old ones keeps them
        self._complete, self.told_hash = False, None

    def snapshot(self) -> Snapshot | None:
        """The whole set to keep for another day; None if it was not fetched."""
        return Snapshot(tuple(self._parameters.values()), self.told_hash) if self._complete else None

    # What is asked

    def read(self, which: str | int, now: float, *, timeout: float | None = None) -> GetParameter:
        """Ask for one parameter, by name or index; its result is the `Parameter`."""
        if isinstance(which, str):
            name_field(which)
        elif not 0 <= which < 32768:
            raise InvalidArgumentError(f"no parameter can be asked for by index {which}")
        return self.begin(GetParameter(which, timeout=timeout), now)

    def set(
        self, name: str, value: Value, now: float, *, kind: int | None = None, timeout: float | None = None
    ) -> SetParameter:
        """Set a parameter and see it read back; its result is the `Parameter` as it is now.

        The type is that which the component told; if it told none yet, and `kind` gives none, it is asked.
        """
        return self.begin(SetParameter(name_field(name), value, kind, timeout=timeout), now)

    def download(
        self,
        now: float,
        *,
        known: Snapshot | None = None,
        timeout: float | None = None,
        idle_timeout: float = 10.0,
    ) -> DownloadParameters:
        """Fetch the whole set; its result are the parameters by name, in the order of their table.

        If the component tells the hash of a `known` set, that is the result, and nothing is transferred.
        """
        return self.begin(
            DownloadParameters(self.round_trip, known, timeout=timeout, idle_timeout=idle_timeout), now
        )

    def read_hash(self, now: float, *, timeout: float | None = None) -> ReadHash:
        """Ask for the hash of all parameters, which PX4 knows; its result is the number."""
        return self.begin(ReadHash(timeout=timeout), now)

    def take_packed(self, data: bytes, now: float, *, begun: float | None = None, start: int = 0) -> bool:
        """Take in a downloaded packed file; False if it is damaged.

        What was told after `begun`, when its download began, is newer than the file and stays.
        """
        packed = unpack(data, start=start)
        if packed is None:
            return False
        self.take_packed_file(packed, now, begun=begun)
        return True

    def take_packed_file(self, packed: PackedFile, now: float, *, begun: float | None = None) -> None:
        """Take in a packed file that was read already."""
        since = now if begun is None else begun
        for parameter in packed.parameters:
            if self._told_at.get(parameter.name, since) <= since:
                self._learn(parameter, now)
        self.defaults.update(packed.defaults)
        if packed.whole:
            self.now_whole([parameter.name for parameter in packed.parameters], None)

    # As a client

    def conflicts(self, new: Operation[Any], running: Operation[Any]) -> bool:
        if isinstance(new, SetParameter):
            return isinstance(running, SetParameter) and new.name == running.name
        return isinstance(new, DownloadParameters) and isinstance(running, DownloadParameters)

    def observe(self, packet: Packet, now: float) -> None:
        self.heard = None
        match packet.message:
            case common.ParamValue(param_id=name) as message if name == HASH_NAME:
                self.told_hash = int.from_bytes(field_of(message), "little")
            case common.ParamValue(param_id=name) as message if name:
                overtaken = self._reorder_filter.is_overtaken(packet.sequence, now)
                parameter = read_value(message, self._encoding)
                self.heard = Heard(parameter, message.param_count, overtaken)
                if not overtaken or name not in self._parameters:
                    self._learn(parameter, now)

    def now_whole(self, names: list[str], told_hash: int | None) -> None:
        """These are all parameters there are, in their order; others are gone."""
        known = self._parameters
        self._parameters = {name: known[name] for name in names if name in known}
        self._told_at = {name: self._told_at[name] for name in self._parameters}
        self._complete, self.told_hash = True, told_hash

    def take_snapshot(self, snapshot: Snapshot, told_hash: int, now: float) -> None:
        """The component's parameters are those of a snapshot."""
        for parameter in snapshot.parameters:
            self._learn(parameter, now)
        self.now_whole([parameter.name for parameter in snapshot.parameters], told_hash)

    def say_rounded(self, name: str, asked: Value, sent: Value) -> None:
        """Tell the program that a value lost digits."""
        self.emit(ParameterRounded(name, asked, sent))

    def _learn(self, parameter: Parameter, now: float) -> None:
        name = parameter.name
        previous = self._parameters.get(name)
        if previous is None and len(self._parameters) >= MAX_PARAMETERS:
            return
        self._parameters[name] = _with_index(parameter, previous)
        self._told_at[name] = now
        if previous is None or not _alike(parameter, previous):
            if previous is not None:
                self.told_hash = None  # it was told for the values before
            self.emit(ParameterChanged(parameter, previous))


def _alike(one: Parameter, other: Parameter) -> bool:
    return one.type == other.type and same(one.value, other.value)


def _with_index(parameter: Parameter, previous: Parameter | None) -> Parameter:
    if parameter.index is not None or previous is None or previous.index is None:
        return parameter
    return Parameter(parameter.name, parameter.value, parameter.type, previous.index, parameter.exact)

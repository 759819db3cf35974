"""The parameter client of one component (guide: parameter protocol).

`ParameterClient.parameters` is updated by every PARAM_VALUE of the component, requested or not; each
change is emitted as `ParameterChanged`. The encoding of values follows from the component (`encoding_of`); a
change of the encoding discards all values.
"""

from __future__ import annotations

from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.services.addressing import Address, message_ids
from mavstack.services.operation import Client, Operation
from mavstack.services.parameters.cache import ReceivedParameter, Snapshot
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
    """A parameter was received for the first time (`previous` is None), or with another value."""

    parameter: Parameter
    previous: Parameter | None


@dataclass(frozen=True, slots=True)
class ParameterRounded(Event):
    """A value to set lost digits in the encoding: `requested` became `sent`."""

    name: str
    requested: Value
    sent: Value


class ParameterClient(Client):
    """The parameter client of one component."""

    handles = message_ids(common.ParamValue, common.ParamError)

    def __init__(self, local: Address, target: Address, encoding: Encoding = Encoding.BYTEWISE) -> None:
        if not target.system or not target.component:
            raise InvalidArgumentError(f"the target of parameters must be one component, got {target}")
        super().__init__(local, target)
        self.round_trip = RoundTrip(initial=1.0, minimum=0.05, maximum=2.0)
        #: The parameter of the packet that is being received; the operations read it.
        self.received: ReceivedParameter | None = None
        self.remote_hash: int | None = None
        self.defaults: dict[str, Value] = {}
        self._encoding = encoding
        self._parameters: dict[str, Parameter] = {}
        self._received_at: dict[str, float] = {}
        self._reorder_filter = ReorderFilter()
        self._complete = False

    # State

    @property
    def parameters(self) -> Mapping[str, Parameter]:
        """All received parameters, by name."""
        return MappingProxyType(self._parameters)

    @property
    def complete(self) -> bool:
        """True if the complete set was downloaded."""
        return self._complete

    @property
    def encoding(self) -> Encoding:
        """The encoding of values; a change discards all received values."""
        return self._encoding

    @encoding.setter
    def encoding(self, encoding: Encoding) -> None:
        if encoding is not self._encoding:
            self._encoding = encoding
            self._clear()

    def clear_cache(self, now: float) -> None:
        """Discard all parameters, because the component rebooted; a running download restarts."""
        self._clear()
        for operation in self._running:
            if isinstance(operation, DownloadParameters):
                operation.restart_download(now)

    def _clear(self) -> None:
        self._parameters, self._received_at = {}, {}  # new mappings, because callers may hold the old ones
        self._complete, self.remote_hash = False, None

    def snapshot(self) -> Snapshot | None:
        """Return the complete set for a later `download`; None if it was not downloaded."""
        return Snapshot(tuple(self._parameters.values()), self.remote_hash) if self._complete else None

    # Operations

    def get(self, which: str | int, now: float, *, timeout: float | None = None) -> GetParameter:
        """Request one parameter.

        Args:
            which: Its name or index.
            now: The time, Unix seconds.
            timeout: Seconds for the complete operation; None sets no overall limit.

        Returns:
            The operation, whose result is the `Parameter`.

        Raises:
            InvalidArgumentError: The name or the index is invalid.
        """
        if isinstance(which, str):
            name_field(which)
        elif not 0 <= which < 32768:
            raise InvalidArgumentError(f"a parameter index must be from 0 to 32767, got {which}")
        return self.begin(GetParameter(which, timeout=timeout), now)

    def set(
        self, name: str, value: Value, now: float, *, kind: int | None = None, timeout: float | None = None
    ) -> SetParameter:
        """Set a parameter and confirm its value.

        Args:
            name: Its name.
            value: The new value.
            now: The time, Unix seconds.
            kind: Its MAV_PARAM_TYPE; None: as received from the component, which is asked if necessary.
            timeout: Seconds for the complete operation; None sets no overall limit.

        Returns:
            The operation, whose result is the `Parameter` with its new value.

        Raises:
            InvalidArgumentError: The name is invalid. The operation fails with it if the parameter's type or
                the encoding cannot hold the value.
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
        """Download the complete set.

        Args:
            now: The time, Unix seconds.
            known: A set that is the result without a transfer, if the component sends its hash.
            timeout: Seconds for the complete operation; None sets no overall limit.
            idle_timeout: Seconds without progress after which the operation fails.

        Returns:
            The operation, whose result are the parameters by name, in the order of the table.
        """
        return self.begin(
            DownloadParameters(self.round_trip, known, timeout=timeout, idle_timeout=idle_timeout), now
        )

    def read_hash(self, now: float, *, timeout: float | None = None) -> ReadHash:
        """Request the hash of all parameters, which PX4 supports; the result is the number."""
        return self.begin(ReadHash(timeout=timeout), now)

    def load_packed(
        self, data: bytes, now: float, *, started_at: float | None = None, start: int = 0
    ) -> bool:
        """Load a downloaded packed file; returns False if it is damaged.

        Values received after `started_at`, when its download began, are newer than the file and stay.
        """
        packed = unpack(data, start=start)
        if packed is None:
            return False
        self.load_packed_file(packed, now, started_at=started_at)
        return True

    def load_packed_file(self, packed: PackedFile, now: float, *, started_at: float | None = None) -> None:
        """Load a decoded packed file."""
        since = now if started_at is None else started_at
        for parameter in packed.parameters:
            if self._received_at.get(parameter.name, since) <= since:
                self._store(parameter, now)
        self.defaults.update(packed.defaults)
        if packed.complete:
            self.set_complete([parameter.name for parameter in packed.parameters], None)

    # Methods of a client

    def conflicts(self, new: Operation[Any], running: Operation[Any]) -> bool:
        if isinstance(new, SetParameter):
            return isinstance(running, SetParameter) and new.name == running.name
        return isinstance(new, DownloadParameters) and isinstance(running, DownloadParameters)

    def observe(self, packet: Packet, now: float) -> None:
        self.received = None
        match packet.message:
            case common.ParamValue(param_id=name) as message if name == HASH_NAME:
                self.remote_hash = int.from_bytes(field_of(message), "little")
            case common.ParamValue(param_id=name) as message if name:
                reordered = self._reorder_filter.is_reordered(packet.sequence, now)
                parameter = read_value(message, self._encoding)
                self.received = ReceivedParameter(parameter, message.param_count, reordered)
                if not reordered or name not in self._parameters:
                    self._store(parameter, now)

    def set_complete(self, names: list[str], remote_hash: int | None) -> None:
        """Record that these are all parameters, in their order; others are removed."""
        known = self._parameters
        self._parameters = {name: known[name] for name in names if name in known}
        self._received_at = {name: self._received_at[name] for name in self._parameters}
        self._complete, self.remote_hash = True, remote_hash

    def load_snapshot(self, snapshot: Snapshot, remote_hash: int, now: float) -> None:
        """Use the parameters of a snapshot."""
        for parameter in snapshot.parameters:
            self._store(parameter, now)
        self.set_complete([parameter.name for parameter in snapshot.parameters], remote_hash)

    def report_rounded(self, name: str, requested: Value, sent: Value) -> None:
        """Emit `ParameterRounded`."""
        self.emit(ParameterRounded(name, requested, sent))

    def _store(self, parameter: Parameter, now: float) -> None:
        name = parameter.name
        previous = self._parameters.get(name)
        if previous is None and len(self._parameters) >= MAX_PARAMETERS:
            return
        self._parameters[name] = _with_index(parameter, previous)
        self._received_at[name] = now
        if previous is None or not _equal(parameter, previous):
            if previous is not None:
                self.remote_hash = None  # the hash belongs to the values before the change
            self.emit(ParameterChanged(parameter, previous))


def _equal(one: Parameter, other: Parameter) -> bool:
    return one.type == other.type and same(one.value, other.value)


def _with_index(parameter: Parameter, previous: Parameter | None) -> Parameter:
    if parameter.index is not None or previous is None or previous.index is None:
        return parameter
    return Parameter(parameter.name, parameter.value, parameter.type, previous.index, parameter.exact)

"""What a `ParameterClient` asks: one parameter, a new value, all of them, or their hash.

A set is answered by the PARAM_VALUE that reads back what the component has now. Some answer only a change,
so that in every second attempt the value is asked for beside. A value that came from elsewhere, or that is on
its way since before, is not taken for a refusal, nor one that was asked for, as the new one may have been
lost: only the third answer in vain is. Of a name that they do not have some say nothing, some a PARAM_ERROR,
and PX4 before that message existed a STATUSTEXT.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar, cast

from mavstack.dialects import common
from mavstack.errors import LocalProtocolError
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
    same,
    shortest,
    survives,
    with_field,
)

if TYPE_CHECKING:
    from mavstack.dialects import Message
    from mavstack.services.parameters.client import Heard, ParameterClient, Snapshot
    from mavstack.services.timing import RoundTrip
    from mavstack.wire import Packet

Result = TypeVar("Result")

BY_NAME = -1
UNKNOWN_TEXT = "unknown param: "
UNKNOWN_INDEX_TEXT = "unknown param ID: "


class ParameterOperation(RetryingRequest[Result]):
    """An operation of a `ParameterClient` that sends one request until it is answered."""

    handles = message_ids(common.Statustext)

    @property
    def parameters(self) -> ParameterClient:
        """The client that runs it."""
        return cast("ParameterClient", self.client)

    @property
    def round_trip(self) -> RoundTrip:
        return self.parameters.round_trip

    def receive(self, packet: Packet, now: float) -> None:
        match packet.message:
            case common.ParamError() as error:
                if self.is_mine(error):
                    self.answered(now)
                    self.fail(denied(self, int(error.error)))
            case common.ParamValue() as message:
                self.value_came(message, now)
            case common.Statustext(text=text) if text.endswith(self.unknown_text()):
                self.fail(denied(self, common.MavParamError.DOES_NOT_EXIST))

    def unknown_text(self) -> str:
        """The end of the text that says that what is asked does not exist."""
        return UNKNOWN_TEXT + HASH_NAME

    def is_mine(self, error: common.ParamError) -> bool:
        """Whether a PARAM_ERROR is about what is asked."""
        return False

    def value_came(self, message: common.ParamValue, now: float) -> None:
        """A PARAM_VALUE of the target."""


class GetParameter(ParameterOperation[Parameter]):
    """Asks for one parameter by name or index."""

    def __init__(self, which: str | int, *, timeout: float | None = None) -> None:
        super().__init__(f"reading parameter {which} of", timeout=timeout)
        self.which = which

    def send_request(self) -> None:
        self.send(read_request(self.target.system, self.target.component, self.which))

    def unknown_text(self) -> str:
        return (
            UNKNOWN_TEXT + self.which if isinstance(self.which, str) else f"{UNKNOWN_INDEX_TEXT}{self.which}"
        )

    def is_mine(self, error: common.ParamError) -> bool:
        return asks_for(self.which, error.param_id, error.param_index)

    def value_came(self, message: common.ParamValue, now: float) -> None:
        heard = self.parameters.heard
        if heard is None or heard.overtaken:
            return
        if self.which in (heard.parameter.name, heard.parameter.index):
            self.answered(now)
            self.finish(heard.parameter)


class SetParameter(SetRequest[Parameter], ParameterOperation[Parameter]):
    """Sets one parameter and reads it back."""

    def __init__(self, name: str, value: Value, kind: int | None, *, timeout: float | None = None) -> None:
        super().__init__(name, kind, shortest(value), timeout=timeout)
        self._asked = value
        self._wanted: Value | None = None
        self._kept: Parameter | None = None
        self._asks_beside = False

    def known_kind(self) -> int | None:
        known = self.parameters.parameters.get(self.name)
        return None if known is None else known.type

    def reading(self) -> GetParameter:
        return GetParameter(self.name)

    def handle_timeout(self, now: float) -> None:
        if self._kept is not None:
            self._silent = -1
            self._refusals += 0 if self._asks_beside else 1
            if self._refusals >= MAX_REFUSALS:
                self.fail(denied(self, 0, f"it stayed {self._kept.text}"))
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
        wanted = self._asked if self._wanted is None else self._wanted
        self.send(with_field(message, encode(wanted, kind, self.parameters.encoding)))
        self._asks_beside = self.attempts % 2 == 1
        if self._asks_beside:
            self.send(read_request(target.system, target.component, self.name))
        self._kept = None

    def unknown_text(self) -> str:
        return UNKNOWN_TEXT + self.name

    def is_mine(self, error: common.ParamError) -> bool:
        return self._wanted is not None and asks_for(self.name, error.param_id, error.param_index)

    def value_came(self, message: common.ParamValue, now: float) -> None:
        heard = self.parameters.heard
        if heard is None or heard.overtaken or heard.parameter.name != self.name or self._wanted is None:
            return
        cast_value = self.parameters.encoding is Encoding.C_CAST  # whose sender's type says nothing
        right_type = cast_value or heard.parameter.type == self._kind
        if right_type and same(heard.parameter.value, self._wanted):
            self.answered(now)
            self.finish(heard.parameter)
        else:
            self._kept = heard.parameter

    def begin_setting(self, now: float) -> None:
        kind, encoding = self._kind or 0, self.parameters.encoding
        try:
            value = as_type(self.name, self._asked, kind)
        except LocalProtocolError as error:
            self.fail(error)
            return
        self._wanted = decode(encode(value, kind, encoding), kind, encoding)
        if not survives(value, kind, encoding):
            self.parameters.say_rounded(self.name, self._asked, self._wanted)
        self.transmit(now)


class ReadHash(ParameterOperation[int]):
    """Asks for the hash of all parameters."""

    def __init__(self, *, timeout: float | None = None) -> None:
        super().__init__("reading the parameter hash of", timeout=timeout)

    def send_request(self) -> None:
        self.send(read_request(self.target.system, self.target.component, HASH_NAME))

    def is_mine(self, error: common.ParamError) -> bool:
        return asks_for(HASH_NAME, error.param_id, error.param_index)

    def value_came(self, message: common.ParamValue, now: float) -> None:
        told = self.parameters.told_hash
        if message.param_id == HASH_NAME and told is not None:
            self.answered(now)
            self.finish(told)


class DownloadParameters(Listing["dict[str, Parameter]"]):
    """Fetches all parameters, unless their hash is that of a known set."""

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
        """The client that runs it."""
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
                self._hash_came(now)
            case common.ParamValue():
                heard = self.parameters.heard
                if heard is not None and heard.parameter.index is not None:
                    self._entry_came(heard, now)

    def _entry_came(self, heard: Heard, now: float) -> None:
        parameter = heard.parameter
        self.entry_came(parameter.index or 0, heard.count, parameter.name, now, overtaken=heard.overtaken)

    def listed(self, names: list[str], now: float) -> None:
        client = self.parameters
        client.now_whole(names, client.told_hash)
        self.finish(dict(client.parameters))

    def clean_up(self, now: float) -> None:
        """PX4 stops listing when someone sets the hash; others know no such name."""
        if self.parameters.told_hash is not None:
            self._stop_list()

    def _hash_came(self, now: float) -> None:
        told = self.parameters.told_hash
        if self._known is not None and told is not None and told in self._hashes:
            self._stop_list()
            self.parameters.take_snapshot(self._known, told, now)
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
    """The message that asks for one parameter by name or index."""
    by_name = isinstance(which, str)
    return common.ParamRequestRead(
        target_system=system,
        target_component=component,
        param_id=which if isinstance(which, str) else "",
        param_index=BY_NAME if by_name else int(which),
    )


def asks_for(which: str | int, name: str, index: int) -> bool:
    """Whether a PARAM_ERROR, which tells a name, or an index and a name without meaning, is about this."""
    return index == which if isinstance(which, int) else index < 0 and name == which

"""The server that accepts a signing key (SETUP_SIGNING; see `key_change`).

A key is accepted only if the program's policy `may_set` returns no reason against it; without a policy none
is accepted, since the sender of this message controls the vehicle. The node's policy is `trusted_channels`.
ArduPilot also refuses while it is armed; the program may do so too.

A new key is on trial: packets are signed with it, the old way is still accepted, and the client's first
packet that is signed the new way ends the trial. If none arrives within TRIAL_DURATION seconds, the server
rolls back. The timestamp of a key is where the signing clock of a component without a clock begins.

With `as_autopilot` the server behaves as ArduPilot and PX4 do: a key counts at once and permanently, whatever
its timestamp, and may be sent to all systems.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass
from hashlib import sha256
from typing import TYPE_CHECKING, TypeAlias

from mavstack.dialects import common
from mavstack.security import SigningKey
from mavstack.security.timestamps import MAX_TIMESTAMP, UNITS_PER_SECOND
from mavstack.services.addressing import Address, message_ids
from mavstack.services.service import Event, Service
from mavstack.services.signing_setup.key_change import (
    TRIAL_DURATION,
    KeySettled,
    ListenForKey,
    UseNewKey,
    UseOldKey,
    signed_with,
)

if TYPE_CHECKING:
    from mavstack.wire import Packet

_NO_KEY = bytes(32)
_MAX_SEEN = 64
#: The largest initial timestamp, in the year 2103: a signing clock that starts later would soon reach its
#: end, and stay there.
_MAX_TIMESTAMP = MAX_TIMESTAMP - 365 * 24 * 3600 * UNITS_PER_SECOND
_STATUSTEXT_BYTES = 50


@dataclass(frozen=True, slots=True)
class SigningRequest:
    """A request to set a key, or with `disables` to turn signing off."""

    source: Address
    disables: bool
    signed: bool


@dataclass(frozen=True, slots=True)
class SigningRefused(Event):
    """A request to set a key was refused."""

    request: SigningRequest
    reason: str


#: The program's policy: returns the reason why a key may not be set now, or None.
MaySet: TypeAlias = Callable[[SigningRequest], str | None]


@dataclass(slots=True)
class _Trial:
    key: SigningKey | None
    source: Address
    ends_at: float


def refuse_all(request: SigningRequest) -> str | None:
    """Return the reason of the default policy, which refuses every key."""
    return "no policy allows it"


class SigningSetupServer(Service):
    """The signing key of one component; `key` is the initial one.

    Args:
        local: The local component.
        key: The initial key; None for none.
        may_set: The program's policy.
        as_autopilot: Accept a key without a trial, as autopilots do.
    """

    handles = message_ids(common.SetupSigning, common.Heartbeat, common.Timesync)

    def __init__(
        self,
        local: Address,
        *,
        key: SigningKey | None = None,
        may_set: MaySet = refuse_all,
        as_autopilot: bool = False,
    ) -> None:
        super().__init__(local)
        self.key = key
        self._may_set = may_set
        self._as_autopilot = as_autopilot
        self._trial: _Trial | None = None
        self._newest = 0
        self._seen: OrderedDict[bytes, None] = OrderedDict()

    @property
    def on_trial(self) -> bool:
        """True while a new key is in use that may be rolled back."""
        return self._trial is not None

    def receive(self, packet: Packet, now: float) -> None:
        source = Address(packet.system, packet.component)
        trial = self._trial
        if trial is not None and source == trial.source and signed_with(packet, trial.key, now):
            self._settle(changed=True)
        match packet.message:
            case common.SetupSigning(target_system=system, target_component=component) as message:
                if self._is_for_us(Address(system, component)) and not self._is_copy(packet):
                    self._handle(message, SigningRequest(source, _disables(message), packet.signed), now)

    def next_timeout(self) -> float | None:
        return self._trial.ends_at if self._trial else None

    def handle_timeout(self, now: float) -> None:
        if self._trial is not None and now >= self._trial.ends_at:
            self.emit(UseOldKey(self._trial.source))
            self._settle(changed=False)

    def _handle(self, message: common.SetupSigning, request: SigningRequest, now: float) -> None:
        if message.secret_key == _NO_KEY and not request.disables:
            self._refuse(request, "a key of zeros is not allowed")
            return
        if message.initial_timestamp > _MAX_TIMESTAMP:
            self._refuse(request, "the timestamp is too far in the future")
            return
        key = None if request.disables else SigningKey(message.secret_key)
        if not self._as_autopilot and self._is_outdated(key, message.initial_timestamp):
            return
        reason = self._may_set(request)
        if reason is not None:
            self._refuse(request, reason)
            return
        if self._trial is not None:
            self.emit(UseOldKey(self._trial.source))
            self._settle(changed=False)
        self._newest = message.initial_timestamp or self._newest
        self._trial = _Trial(key, request.source, now + TRIAL_DURATION)
        self.emit(ListenForKey(request.source, key, message.initial_timestamp))
        self.emit(UseNewKey(request.source))
        if self._as_autopilot:
            self._settle(changed=True)

    def _is_for_us(self, target: Address) -> bool:
        """Return whether a key was sent to the component; one for all is ignored, except by autopilots."""
        return target == self.local or (self._as_autopilot and target.covers(self.local))

    def _is_outdated(self, key: SigningKey | None, timestamp: int) -> bool:
        """Return whether a request is a repetition, or was reordered behind a newer one."""
        wanted = self._trial.key if self._trial else self.key
        return key == wanted or (key is not None and timestamp <= self._newest)

    def _settle(self, *, changed: bool) -> None:
        trial, self._trial = self._trial, None
        if trial is not None:
            self.key = trial.key if changed else self.key
            self.emit(KeySettled(trial.source, trial.key, changed))

    def _refuse(self, request: SigningRequest, reason: str) -> None:
        self.emit(SigningRefused(request, reason))
        text = f"Signing setup refused: {reason}".encode()[:_STATUSTEXT_BYTES].decode(errors="ignore")
        self.send(common.Statustext(severity=common.MavSeverity.WARNING, text=text), request.source)

    def _is_copy(self, packet: Packet) -> bool:
        """Return whether the packet is a duplicate; stores only its hash, since its bytes contain a key."""
        seen = sha256(packet.raw).digest()
        copy = seen in self._seen
        self._seen[seen] = None
        if len(self._seen) > _MAX_SEEN:
            self._seen.popitem(last=False)
        return copy


def _disables(message: common.SetupSigning) -> bool:
    """Return whether the message turns signing off: a key of zeros and timestamp zero, as on ArduPilot."""
    return message.secret_key == _NO_KEY and message.initial_timestamp == 0

"""The client that sets or removes a component's signing key (SETUP_SIGNING; see `key_change`).

    not seen yet  ── TIMESYNC, until a packet arrives: so a key goes only to a known target
    seen          ── SETUP_SIGNING, signed the old way, repeated until the target signs the new way
    may not send  ── no channel verifies the target, and none was named ──► SigningError
    signs new     ── TIMESYNC, signed the new way, until answered: the target receives the client ──► done
    rolls back    ── requested again, while there is time; after SETTLED_AFTER seconds ──► RemoteDenied
    silence       ──────────────────────────────────────────────────────────────────────► RemoteTimeout

A component that answers no TIMESYNC is trusted after SETTLED_AFTER seconds. If the operation ends earlier,
the client keeps following the target's way, and emits KeySettled later; a new operation waits for it. The
message is sent to one component, never to all, and no text contains its key.
"""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING, Any

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError, RemoteDenied, SigningError
from mavstack.security.timestamps import timestamp_at
from mavstack.services.addressing import Address, message_ids
from mavstack.services.operation import Client, Operation
from mavstack.services.signing_setup.key_change import KeyChange, signed_with

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.security import SigningKey
    from mavstack.wire import Packet

REQUEST_INTERVAL = 0.5
#: Seconds for which requests are sent; then the client only waits.
REQUEST_DURATION = 8.0
DEFAULT_TIMEOUT = 40.0
NO_KEY = bytes(32)
_MAX_PROOFS = 64


class SetupSigning(Operation[None]):
    """The change of the target's signing key; None turns signing off."""

    def __init__(self, key: SigningKey | None, *, timeout: float | None = DEFAULT_TIMEOUT) -> None:
        super().__init__(
            "turning signing off on" if key is None else "setting a signing key on",
            timeout=timeout,
            idle_timeout=DEFAULT_TIMEOUT,
        )
        if key is not None and key.secret_bytes() == NO_KEY:
            raise SigningError("a key of zeros means no signing; pass None instead")
        self.key = key
        self._change: KeyChange | None = None
        self._request_until = 0.0
        self._proofs: deque[int] = deque(maxlen=_MAX_PROOFS)

    def start(self, now: float) -> None:
        self.handle_timeout(now)

    def handle_timeout(self, now: float) -> None:
        self.timer = now + REQUEST_INTERVAL
        change = self._change
        if change is None:
            self._send_timesync(now)
        elif change.uses_new:
            self._proofs.append(self._send_timesync(now))
        elif change.requested_at is None or now < self._request_until:
            self._request(change, now)
        else:
            self._send_timesync(now)

    def receive(self, packet: Packet, now: float) -> None:
        change = self._change
        if change is None:
            # The channels to the target are known only after its first packet.
            if self._refuse_key():
                return
            change = self._change = self._client_of_keys.begin_change(self.key)
            if change is None:
                return
            change.observe(packet, now)
            self.timer = now
        if not change.uses_new:
            self._proofs.clear()
        match packet.message:
            case common.Timesync(tc1=answer, ts1=ours) if answer != 0 and ours in self._proofs:
                change.settle()  # the target received the request, because its answer uses the new signing
        self._end(change)

    def _end(self, change: KeyChange) -> None:
        if change.settled:
            self.finish(None)
        elif change.settled is False:
            answer = "the old key stays in use"
            self.fail(RemoteDenied(self.description, str(self.target), attempts=self.attempts, answer=answer))

    def _request(self, change: KeyChange, now: float) -> None:
        if self.key is not None and self._client_of_keys.key_refusal(self.target) is not None:
            # the channels changed and do not allow the key any more; the client only continues to follow the
            # target
            return
        if change.requested_at is None:
            self._request_until = now + REQUEST_DURATION
        change.requested_at = now
        self.attempts += 1
        secret = NO_KEY if self.key is None else self.key.secret_bytes()
        self.send(
            common.SetupSigning(
                target_system=self.target.system,
                target_component=self.target.component,
                secret_key=secret,
                # For ArduPilot a key of zeros switches signing off only if the timestamp is zero too.
                initial_timestamp=0 if self.key is None else timestamp_at(now),
            )
        )
        self._send_timesync(now)

    def _refuse_key(self) -> bool:
        """Fail if the key may not be sent over the channels to the target."""
        reason = self._client_of_keys.key_refusal(self.target) if self.key is not None else None
        if reason is not None:
            self.fail(SigningError(f"{self} failed: {reason}"))
        return reason is not None

    def _send_timesync(self, now: float) -> int:
        ours = round(now * 1e9)
        self.send(
            common.Timesync(
                tc1=0, ts1=ours, target_system=self.target.system, target_component=self.target.component
            )
        )
        return ours

    @property
    def _client_of_keys(self) -> SigningSetupClient:
        client = self.client
        if not isinstance(client, SigningSetupClient):
            raise InvalidArgumentError(f"{self.description} needs a SigningSetupClient")
        return client


class SigningSetupClient(Client):
    """The client that changes the signing key of one component.

    Args:
        local: The local component.
        target: The component whose key is changed.
        key_refusal: Returns the reason why a key may not be sent to a target now, or None.
        arrived_elsewhere: Returns True while a packet is handled that came over another channel than the one
            that was named for the key: it proves nothing unless it is signed with the new key.
    """

    handles = message_ids(common.Heartbeat, common.Timesync)

    def __init__(
        self,
        local: Address,
        target: Address,
        *,
        key_refusal: Callable[[Address], str | None] = lambda target: None,
        arrived_elsewhere: Callable[[Address], bool] = lambda target: False,
    ) -> None:
        if 0 in target:
            raise InvalidArgumentError(f"a signing key must be sent to one component, got {target}")
        super().__init__(local, target)
        self.key_refusal = key_refusal
        self._arrived_elsewhere = arrived_elsewhere
        self._change: KeyChange | None = None

    @property
    def changing(self) -> bool:
        """True while a change is in progress."""
        return self._change is not None and self._change.settled is None

    def install(
        self, key: SigningKey | None, now: float, *, timeout: float | None = DEFAULT_TIMEOUT
    ) -> SetupSigning:
        """Set the target's signing key; None turns signing off."""
        return self.begin(SetupSigning(key, timeout=timeout), now)

    def begin_change(self, new: SigningKey | None) -> KeyChange | None:
        """Begin a key change; returns None while another is in progress."""
        if self.changing:
            return None
        self._change = KeyChange(self.target, new, self.emit)
        return self._change

    def receive(self, packet: Packet, now: float) -> None:
        if self._arrived_elsewhere(self.target):
            new = self._change.new if self._change is not None else None
            if new is None or not signed_with(packet, new, now):
                return
        super().receive(packet, now)

    def conflicts(self, new: Operation[Any], running: Operation[Any]) -> bool:
        return True

    def observe(self, packet: Packet, now: float) -> None:
        if self._change is not None and self._change.settled is None:
            self._change.observe(packet, now)

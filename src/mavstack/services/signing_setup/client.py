"""Giving a component its signing key, or taking it away, and being sure of it (SETUP_SIGNING; see `change`).

    not heard yet ── TIMESYNC, until anything comes: so a key goes only where the target is known to be
    heard         ── SETUP_SIGNING, signed the old way, repeated until the target signs the new way
    signs new     ── TIMESYNC, signed the new way, until it is answered: the target hears us ──► done
    falls back    ── asked again, while there is time; after QUIET seconds its way stands ──► RemoteDenied
    silence       ──────────────────────────────────────────────────────────────────────► RemoteTimeout

A component that answers no TIMESYNC is believed after QUIET seconds. If the operation ends before that is
known, the client goes on to speak as it is spoken to, and tells KeySettled later; a new operation waits for
it. The message is sent to one component, never to all, and its key stands in no text.
"""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING, Any

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError, RemoteDenied, SigningError
from mavstack.security.timestamps import timestamp_at
from mavstack.services.addressing import Address, message_ids
from mavstack.services.operation import Client, Operation
from mavstack.services.signing_setup.key_change import KeyChange

if TYPE_CHECKING:
    from mavstack.security import SigningKey
    from mavstack.wire import Packet

INTERVAL = 0.5
#: For so long the target is asked; then it is waited for.
ASKING = 8.0
LIMIT = 40.0
NO_KEY = bytes(32)
_MAX_PROOFS = 64


class SetupSigning(Operation[None]):
    """Make the target sign with a key, or not sign if there is none."""

    def __init__(self, key: SigningKey | None, *, timeout: float | None = LIMIT) -> None:
        super().__init__(
            "turning signing off on" if key is None else "setting a signing key on",
            timeout=timeout,
            idle_timeout=LIMIT,
        )
        if key is not None and key.secret_bytes() == NO_KEY:
            raise SigningError("a key of zeros stands for no signing; give None")
        self.key = key
        self._change: KeyChange | None = None
        self._asking_until = 0.0
        self._proofs: deque[int] = deque(maxlen=_MAX_PROOFS)

    def start(self, now: float) -> None:
        self.handle_timeout(now)

    def handle_timeout(self, now: float) -> None:
        self.timer = now + INTERVAL
        change = self._change
        if change is None:
            self._send_timesync(now)
        elif change.speaks_new:
            self._proofs.append(self._send_timesync(now))
        elif change.asked_at is None or now < self._asking_until:
            self._ask(change, now)
        else:
            self._send_timesync(now)

    def receive(self, packet: Packet, now: float) -> None:
        change = self._change
        if change is None:
            # Only now is it known which channels lead to the target.
            change = self._change = self._client_of_keys.begin_change(self.key)
            if change is None:
                return
            change.heard(packet, now)
            self.timer = now
        if not change.speaks_new:
            self._proofs.clear()
        match packet.message:
            case common.Timesync(tc1=answer, ts1=ours) if answer != 0 and ours in self._proofs:
                change.settle()  # the target heard us, and this answer is signed the new way
        self._end(change)

    def _end(self, change: KeyChange) -> None:
        if change.settled:
            self.finish(None)
        elif change.settled is False:
            answer = "it goes on as before"
            self.fail(RemoteDenied(self.description, str(self.target), attempts=self.attempts, answer=answer))

    def _ask(self, change: KeyChange, now: float) -> None:
        if change.asked_at is None:
            self._asking_until = now + ASKING
        change.asked_at = now
        self.attempts += 1
        secret = NO_KEY if self.key is None else self.key.secret_bytes()
        self.send(
            common.SetupSigning(
                target_system=self.target.system,
                target_component=self.target.component,
                secret_key=secret,
                # ArduPilot takes a key of zeros for no signing only if the timestamp is zero too.
                initial_timestamp=0 if self.key is None else timestamp_at(now),
            )
        )
        self._send_timesync(now)

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
            raise InvalidArgumentError(f"{self.description} belongs to a SigningSetupClient")
        return client


class SigningSetupClient(Client):
    """Changes the key of one component."""

    handles = message_ids(common.Heartbeat, common.Timesync)

    def __init__(self, local: Address, target: Address) -> None:
        if 0 in target:
            raise InvalidArgumentError(f"a signing key goes to one component, not to {target}")
        super().__init__(local, target)
        self._change: KeyChange | None = None

    @property
    def changing(self) -> bool:
        """Whether a change is open: it is not known yet how the target goes on."""
        return self._change is not None and self._change.settled is None

    def install(self, key: SigningKey | None, now: float, *, timeout: float | None = LIMIT) -> SetupSigning:
        """Make the target sign with a key, or, without one, not sign."""
        return self.begin(SetupSigning(key, timeout=timeout), now)

    def begin_change(self, new: SigningKey | None) -> KeyChange | None:
        """Open a change of keys; None while another is open."""
        if self.changing:
            return None
        self._change = KeyChange(self.target, new, self.emit)
        return self._change

    def conflicts(self, new: Operation[Any], running: Operation[Any]) -> bool:
        return True

    def observe(self, packet: Packet, now: float) -> None:
        if self._change is not None and self._change.settled is None:
            self._change.heard(packet, now)

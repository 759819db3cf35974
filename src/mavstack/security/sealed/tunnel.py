"""One end of a sealed link to one peer, without sockets and clock.

A tunnel sends over its newest confirmed session and receives over all that have not expired. A new session
never displaces one before the peer has proved it by an authentic frame, so that neither a forged nor a
delayed handshake makes an end deaf. An end that connects begins a handshake

- every two minutes, or after 2^26 frames (re-keying);
- if it has received nothing for six seconds, for example because the peer was restarted;
- if the peer reports a frame of an unknown session, at most once a second.

Each end sends an empty frame when it has sent nothing for two seconds.
"""

from __future__ import annotations

import os
from collections import Counter
from typing import TYPE_CHECKING, Final

from mavstack.security.sealed import messages
from mavstack.security.sealed.connector import Connector
from mavstack.security.sealed.session import HEADER_SIZE, FrameError, Session, slot_of

if TYPE_CHECKING:
    from mavstack.security.sealed.config import SealConfig
    from mavstack.security.sealed.noise import Random
    from mavstack.security.sealed.responder import Responder

REKEY_SECONDS: Final = 120.0
#: Seconds for which the responder waits until the initiator renews the session.
REKEY_GRACE: Final = 15.0
REKEY_FRAMES: Final = 1 << 26
#: Seconds after which a session is not used any more, even if it could not be renewed.
EXPIRE_SECONDS: Final = 600.0
KEEPALIVE: Final = 2.0
CONFIRM_INTERVAL: Final = 0.5
SILENCE: Final = 6.0
UNKNOWN_INTERVAL: Final = 1.0
_MAX_PENDING: Final = 8
_SLOTS: Final = 8


class Tunnel:
    """One end of a sealed link to one peer.

    Args:
        config: The keys and algorithms.
        initiates: True for an end that begins handshakes.
        responder: Answers handshakes; None for an end that only connects.
        address: The address of the peer, to which cookies are bound.
        random: Returns random bytes.

    Attributes:
        counts: Datagrams that were not accepted, by reason.
        peer: The name of the peer's key; empty with a pre-shared key.
    """

    def __init__(
        self,
        config: SealConfig,
        *,
        initiates: bool,
        responder: Responder | None = None,
        address: bytes = b"",
        random: Random = os.urandom,
    ) -> None:
        self._connector = Connector(config, random) if initiates else None
        self._responder = responder
        self._address = address
        self._slots: list[Session | None] = [None] * _SLOTS
        self._pending: list[Session] = []
        self._current: Session | None = None
        self._outgoing: list[bytes] = []
        self._last_sent = self._last_received = self._last_notice = float("-inf")
        self.counts: Counter[str] = Counter()
        self.peer = ""

    @property
    def is_open(self) -> bool:
        """True if there is a session to send over."""
        return self._current is not None

    @property
    def refusals(self) -> Counter[str]:
        """Datagrams that were not accepted, by reason, without those that the responder refused."""
        return self.counts + (self._connector.refusals if self._connector is not None else Counter())

    @property
    def unanswered(self) -> int:
        """Handshakes that were begun since the last session."""
        return self._connector.unanswered if self._connector is not None else 0

    def datagrams_to_send(self) -> list[bytes]:
        """Return handshake messages and empty frames that wait to be sent."""
        outgoing, self._outgoing = self._outgoing, []
        return outgoing

    def seal(self, content: bytes, now: float) -> bytes:
        """Return content as a datagram of `session.OVERHEAD` more bytes; empty if there is no session."""
        session = self._current
        if session is None:
            return b""
        self._last_sent = now
        return session.seal(content)

    def receive(self, datagram: bytes, now: float) -> bytes:
        """Receive a datagram; return its content, which is empty for all but frames of the peer."""
        slot = slot_of(datagram)
        if slot is not None:
            return self._receive_frame(slot, datagram, now)
        self._receive_handshake(datagram, now)
        return b""

    def next_timeout(self, now: float) -> float:
        """Return when `handle_timeout` is due, in seconds."""
        due = [self._last_sent + self._keepalive()] if self._current else []
        if self._connector is not None:
            reason = self._handshake_due()
            due.append(max(reason, self._connector.next_attempt))
        return max(now, min(due, default=now + KEEPALIVE))

    def handle_timeout(self, now: float) -> None:
        """Begin a handshake or send an empty frame, if it is time."""
        if self._current is not None and now - self._current.started >= EXPIRE_SECONDS:
            self._current = None
        connector = self._connector
        if connector is not None and now >= max(self._handshake_due(), connector.next_attempt):
            self._outgoing.append(connector.begin(now))
        if self._current is not None and now - self._last_sent >= self._keepalive():
            self._outgoing.append(self.seal(b"", now))

    def _keepalive(self) -> float:
        session = self._current
        return KEEPALIVE if session is not None and session.confirmed else CONFIRM_INTERVAL

    def _handshake_due(self) -> float:
        session = self._current
        if session is None:
            return float("-inf")
        silent = max(self._last_received, session.started) + SILENCE
        if not session.initiator:  # the peer initiated the session, and is the one to renew it
            return min(session.started + REKEY_SECONDS + REKEY_GRACE, silent)
        if session.sent >= REKEY_FRAMES:
            return float("-inf")
        return min(session.started + REKEY_SECONDS, silent)

    def _receive_frame(self, slot: int, frame: bytes, now: float) -> bytes:
        session = self._slots[slot]
        reason = "no session"
        candidates = [session] if session is not None else []
        candidates += [each for each in self._pending if each.slot == slot]
        for candidate in candidates:
            if now - candidate.started >= EXPIRE_SECONDS:
                continue
            try:
                content = candidate.open(frame)
            except FrameError as error:
                reason = str(error)
                continue
            self._last_received = now
            if candidate is not session:
                self._confirm(candidate, now)
            return content
        self.counts[reason] += 1
        if reason == "no session" and self._responder is not None:
            self._report_unknown(frame, now)
        return b""

    def _confirm(self, session: Session, now: float) -> None:
        """Begin to use a session that the peer made, after its first authentic frame."""
        self._pending.clear()
        self._use(session)
        if self._connector is not None:
            self._connector.cancel(now)

    def _use(self, session: Session) -> None:
        self._slots[session.slot] = self._current = session
        self.peer = session.peer

    def _report_unknown(self, frame: bytes, now: float) -> None:
        if now - self._last_notice >= UNKNOWN_INTERVAL:
            self._last_notice = now
            self._outgoing.append(bytes((messages.UNKNOWN,)) + frame[:HEADER_SIZE])

    def _receive_handshake(self, data: bytes, now: float) -> None:
        kind = data[0] if data else 0
        responder, connector = self._responder, self._connector
        if connector is not None and connector.is_own(data):  # a message of this end came back
            self.counts["reflected"] += 1
        elif responder is not None and kind == messages.HELLO:
            self._send(responder.hello(data, self._address, now).data)
        elif responder is not None and kind == messages.INITIATE:
            reply = responder.initiate(data, self._address, now)
            self._send(reply.data)
            if reply.session is not None:
                self._pending = [*self._pending, reply.session][-_MAX_PENDING:]
        elif connector is not None and kind == messages.CHALLENGE:
            self._send(connector.challenge(data))
        elif connector is not None and kind == messages.RESPOND:
            self._finish(connector.respond(data, now), now)
        elif connector is not None and kind == messages.UNKNOWN:
            self._restart(connector, data, now)
        else:
            self.counts["malformed"] += 1

    def _finish(self, session: Session | None, now: float) -> None:
        if session is not None:
            self._use(session)
            self._send(self.seal(b"", now))  # an empty frame confirms the session to the peer

    def _restart(self, connector: Connector, data: bytes, now: float) -> None:
        """Begin a handshake because the peer does not know our session; keep the session."""
        session = self._current
        if len(data) != messages.UNKNOWN_SIZE or session is None or not session.has_sent(data[1:]):
            self.counts["malformed"] += 1
        elif now >= connector.next_attempt:
            self._send(connector.begin(now))

    def _send(self, data: bytes) -> None:
        if data:
            self._outgoing.append(data)

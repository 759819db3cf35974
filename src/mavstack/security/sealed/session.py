"""One session: frames with 20 bytes more than their content, each accepted once.

    header, 4 bytes, big-endian: 1 (bit 31), sent by the initiator (bit 30), epoch (bits 29-28), counter
    (the low 28 bits)
    the encrypted content, and its tag of 16 bytes

The nonce is the whole counter of 64 bits, which the receiver completes from its low bits and the highest
counter that it has accepted; the header is authenticated. A window of 1,024 counters lets frames arrive in
another order. Only an authentic frame moves the window.
"""

from __future__ import annotations

from typing import Final

from cryptography.exceptions import InvalidTag

from mavstack.security.sealed.noise import TAG_SIZE, Suite

HEADER_SIZE: Final = 4
#: Size of a frame without its content in bytes.
OVERHEAD: Final = HEADER_SIZE + TAG_SIZE
WINDOW: Final = 1024
EPOCHS: Final = 4
_COUNTER_BITS: Final = 28
_COUNTER_MASK: Final = (1 << _COUNTER_BITS) - 1
_HALF: Final = 1 << (_COUNTER_BITS - 1)
_WINDOW_MASK: Final = (1 << WINDOW) - 1
_FRAME_BIT: Final = 1 << 31


class FrameError(Exception):
    """A frame that is forged or was received before; its text is the reason."""


def slot_of(frame: bytes) -> int | None:
    """Return the slot of the session of a frame, 0 to 7, or None if it is no frame.

    The slot has the epoch in its two low bits, and 4 if the sender is the initiator of the session.
    """
    return frame[0] >> 4 & 7 if len(frame) >= OVERHEAD and frame[0] & 0x80 else None


class Session:
    """The keys and counters of one session.

    Args:
        suite: The algorithms.
        keys: The keys for sending and receiving.
        epoch: The number of the session, 0 to 3.
        initiator: True at the end that began the handshake.
        now: The time in seconds.
        peer: The name of the peer.
    """

    def __init__(
        self,
        suite: Suite,
        keys: tuple[bytes, bytes],
        epoch: int,
        *,
        initiator: bool,
        now: float,
        peer: str = "",
    ) -> None:
        self._suite = suite
        self._sender, self._receiver = suite.cipher(keys[0]), suite.cipher(keys[1])
        self._flags = _FRAME_BIT | initiator << 30 | epoch << _COUNTER_BITS
        #: The slot number in received frames; see `slot_of`.
        self.slot = epoch | (not initiator) << 2
        self.epoch, self.initiator, self.started, self.peer = epoch, initiator, now, peer
        #: Number of sent frames.
        self.sent = 0
        self._top = -1
        self._seen = 0

    @property
    def confirmed(self) -> bool:
        """True after the first authentic frame of the peer."""
        return self._top >= 0

    def seal(self, content: bytes) -> bytes:
        """Return content as the next frame."""
        counter = self.sent
        self.sent = counter + 1
        header = (self._flags | counter & _COUNTER_MASK).to_bytes(HEADER_SIZE, "big")
        return header + self._sender.encrypt(self._suite.nonce(counter), content, header)

    def has_sent(self, header: bytes) -> bool:
        """Return whether a header is that of one of the last frames sent."""
        number = int.from_bytes(header, "big")
        behind = (self.sent - 1 - number) & _COUNTER_MASK
        return number & ~_COUNTER_MASK == self._flags and behind < min(WINDOW, self.sent)

    def open(self, frame: bytes) -> bytes:
        """Return the content of a frame.

        Raises:
            FrameError: It is forged or was received before.
        """
        header = frame[:HEADER_SIZE]
        counter = self._complete(int.from_bytes(header, "big") & _COUNTER_MASK)
        ahead = counter - self._top
        if ahead <= 0 and (ahead <= -WINDOW or self._seen >> -ahead & 1):
            raise FrameError("replayed")
        try:
            content = self._receiver.decrypt(self._suite.nonce(counter), frame[HEADER_SIZE:], header)
        except InvalidTag:
            raise FrameError("forged") from None
        if ahead > 0:
            self._top = counter
            self._seen = (self._seen << ahead | 1) & _WINDOW_MASK if ahead < WINDOW else 1
        else:
            self._seen |= 1 << -ahead
        return content

    def _complete(self, low: int) -> int:
        """Return the counter with these low bits that is nearest to the highest accepted one."""
        top = max(self._top, 0)
        counter = top & ~_COUNTER_MASK | low
        if counter - top > _HALF and counter > _COUNTER_MASK:
            return counter - _COUNTER_MASK - 1
        if top - counter > _HALF:
            return counter + _COUNTER_MASK + 1
        return counter

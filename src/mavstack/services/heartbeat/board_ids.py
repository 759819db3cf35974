"""The unique ids of the boards that use one address, by channel (AUTOPILOT_VERSION).

Two ids contradict each other if the same field of both is known and differs. MAVLink 1 carries the short id
only, so one vehicle has a long id on one link and none on the other. A board cannot be replaced between two
packets: of two senders each is heard again after the other one was. A simulator that is restarted, or a board
that was swapped, is never heard again.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mavstack.services.version import AutopilotVersion

#: Seconds without a packet after which a board is no evidence of a conflict; the ids of boards on one channel
#: are requested more often.
MAX_AGE = 10.0
MAX_BOARDS = 4
MAX_CHANNELS = 8


@dataclass(slots=True)
class Board:
    """One unique id, and when packets of its channels were received.

    Attributes:
        uid: The short id; 0: none.
        uid2: The long id; empty or zeros: none.
        first_seen: When it was reported first, Unix seconds.
        last_seen: When it was reported last, or a packet of a channel that it has alone.
        channels: The channels on which it was reported.
    """

    uid: int
    uid2: bytes
    first_seen: float
    last_seen: float
    channels: dict[str, float] = field(default_factory=dict)

    @property
    def unique_id(self) -> str:
        """The id in hexadecimal, the long one if it is known."""
        return self.uid2.hex() if any(self.uid2) else f"{self.uid:016x}"

    def contradicts(self, uid: int, uid2: bytes) -> bool:
        """Return whether another id is surely that of another board."""
        if any(self.uid2) and any(uid2):
            return self.uid2 != uid2
        return bool(self.uid and uid) and self.uid != uid


class BoardIds:
    """The boards that use one address."""

    def __init__(self) -> None:
        self._boards: list[Board] = []

    def report(self, version: AutopilotVersion, now: float, channel: str) -> None:
        """Record the ids of an AUTOPILOT_VERSION; empty ids contradict none."""
        uid, uid2 = version.uid, version.uid2
        if not uid and not any(uid2):
            return
        board = next((each for each in self._boards if not each.contradicts(uid, uid2)), None)
        if board is None:
            board = self._add(Board(uid, uid2, now, now))
        board.uid, board.uid2 = uid or board.uid, uid2 if any(uid2) else board.uid2
        board.last_seen = now
        if channel in board.channels or len(board.channels) < MAX_CHANNELS:
            board.channels[channel] = now

    def heard(self, now: float, channel: str) -> None:
        """Record a packet of a channel: it is of the board that this channel has alone."""
        if (board := self.on(channel)) is not None:
            board.last_seen = now

    def on(self, channel: str) -> Board | None:
        """Return the board of a channel; None: none was reported, or several."""
        found = [board for board in self._boards if channel in board.channels]
        return found[0] if len(found) == 1 else None

    def interleaved(self, now: float) -> tuple[Board, ...]:
        """Return the boards that are heard side by side; empty if one board uses the address."""
        recent = [board for board in self._boards if now - board.last_seen < MAX_AGE]
        if len(recent) < 2:
            return ()
        newest = max(board.first_seen for board in recent)
        found = tuple(board for board in recent if board.last_seen > newest or board.first_seen == newest)
        return found if len(found) > 1 else ()

    def forget_channel(self, channel: str) -> None:
        """Forget a channel, whose sender may be another one when it returns."""
        for board in self._boards:
            board.channels.pop(channel, None)
        self._boards = [board for board in self._boards if board.channels]

    def _add(self, board: Board) -> Board:
        if len(self._boards) >= MAX_BOARDS:
            self._boards.remove(min(self._boards, key=lambda each: each.last_seen))
        self._boards.append(board)
        return board

"""Our own heartbeat, once a second, sent by the loop that does the work: if that hangs, so does this."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.services.service import Service

if TYPE_CHECKING:
    from mavstack.services.addressing import Address

INTERVAL = 1.0
#: `mavlink_version` of HEARTBEAT: the version of the common dialect.
PROTOCOL_VERSION = 3


class Beacon(Service):
    """Sends HEARTBEAT; its fields may be set at any time, and `soon` sends one at once.

    `autopilot` is INVALID for whatever is not a flight controller (guide: heartbeat).
    """

    def __init__(
        self,
        local: Address,
        type: int = common.MavType.GCS,  # noqa: A002 (the field's name)
        autopilot: int = common.MavAutopilot.INVALID,
        *,
        interval: float = INTERVAL,
    ) -> None:
        super().__init__(local)
        self.type = type
        self.autopilot = autopilot
        self.base_mode = 0
        self.custom_mode = 0
        self.system_status: int = common.MavState.ACTIVE
        self.interval = interval
        self._due = 0.0

    def soon(self, now: float) -> None:
        """Say at once that something has changed."""
        self._due = now

    def next_timeout(self) -> float | None:
        return self._due

    def handle_timeout(self, now: float) -> None:
        if now < self._due:
            return
        # The rate is kept without drift, but a stall is not made up for.
        late = now - self._due
        self._due = now + self.interval - (late if late < self.interval else 0.0)
        self.send(
            common.Heartbeat(
                type=self.type,
                autopilot=self.autopilot,
                base_mode=self.base_mode,
                custom_mode=self.custom_mode,
                system_status=self.system_status,
                mavlink_version=PROTOCOL_VERSION,
            )
        )

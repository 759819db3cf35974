"""The local component's HEARTBEAT, once a second, from the loop that does the work: both stop together."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.services.service import Service

if TYPE_CHECKING:
    from mavstack.services.addressing import Address

DEFAULT_INTERVAL = 1.0
#: `mavlink_version` of HEARTBEAT: the version of the common dialect.
PROTOCOL_VERSION = 3


class HeartbeatSender(Service):
    """The sender of the local component's HEARTBEAT; its fields may be set at any time.

    Args:
        local: The local component.
        type: Its MAV_TYPE.
        autopilot: Its MAV_AUTOPILOT; INVALID for everything but flight controllers (guide: heartbeat).
        interval: Seconds between two heartbeats.
    """

    def __init__(
        self,
        local: Address,
        type: int = common.MavType.GCS,  # noqa: A002 (the field's name)
        autopilot: int = common.MavAutopilot.INVALID,
        *,
        interval: float = DEFAULT_INTERVAL,
    ) -> None:
        super().__init__(local)
        self.type = type
        self.autopilot = autopilot
        self.base_mode = 0
        self.custom_mode = 0
        self.system_status: int = common.MavState.ACTIVE
        self.interval = interval
        #: False while no heartbeats are sent, as over a link of high latency.
        self.enabled = True
        self._due = 0.0

    def send_now(self, now: float) -> None:
        """Send the next heartbeat at once, because a field changed."""
        self._due = now

    def next_timeout(self) -> float | None:
        return self._due

    def handle_timeout(self, now: float) -> None:
        if now < self._due:
            return
        # A late heartbeat does not delay the following ones; heartbeats missed during a stall are not sent
        # later.
        late = now - self._due
        self._due = now + self.interval - (late if late < self.interval else 0.0)
        if not self.enabled:
            return
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

"""The heartbeats of a bridge, which pause while its flight controller is silent."""

from __future__ import annotations

from mavstack.services.heartbeat import HeartbeatSender


class ControllerHeartbeat(HeartbeatSender):
    """The sender of HEARTBEAT for a flight controller."""

    #: True while the flight controller does not answer; then no heartbeat is sent.
    silent = False

    def next_timeout(self) -> float | None:  # noqa: D102 (that of `Service`)
        return None if self.silent else super().next_timeout()

    def handle_timeout(self, now: float) -> None:  # noqa: D102
        if not self.silent:
            super().handle_timeout(now)

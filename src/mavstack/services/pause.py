"""A pause as a step of a procedure."""

from __future__ import annotations

from mavstack.services.operation import Operation


class Pause(Operation[None]):
    """A pause of some seconds, as a step of a procedure."""

    def __init__(self, seconds: float) -> None:
        super().__init__("pausing before the next request to", idle_timeout=seconds + 1)
        self._seconds = seconds

    def start(self, now: float) -> None:
        self.timer = now + self._seconds

    def handle_timeout(self, now: float) -> None:
        self.finish(None)

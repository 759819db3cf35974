"""PX4's log streaming: the log of the vehicle, streamed to the client that asks for it, armed or not."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.services.log_streaming import LogStreamSender, LogStreamStarted, LogStreamStopped

if TYPE_CHECKING:
    from mavstack.sim.storage.flight_logs import LogWriter
    from mavstack.sim.vehicle import SimulatedVehicle


class LogStreaming:
    """The stream of one boot; a periodic check of the autopilot."""

    def __init__(self, vehicle: SimulatedVehicle) -> None:
        self._vehicle = vehicle
        self._logs = vehicle.storage.logs
        self._logs.streams.clear()  # streams do not continue after a reboot
        self._writer: LogWriter | None = None
        self.sender = vehicle.engine.add(LogStreamSender(vehicle.address))
        self.sender.answer_commands(vehicle.commands, vehicle.engine.touch)
        vehicle.on_event(LogStreamStarted, self._started)
        vehicle.on_event(LogStreamStopped, self._stopped)

    def tick(self, now: float) -> None:
        """Send the records since the last tick."""
        if self._writer is not None and self._writer.data:
            self._send(now, acknowledged=False)
            self.sender.flush()

    def _send(self, now: float, *, acknowledged: bool) -> None:
        if self._writer is not None:
            self.sender.write(bytes(self._writer.data), now, acknowledged=acknowledged)
            self._writer.data.clear()
            self._vehicle.touch(self.sender)

    def _started(self, event: LogStreamStarted) -> None:
        self._stopped(LogStreamStopped())
        self._writer = self._logs.open_stream(self._vehicle.uptime_ms * 1000)
        self._send(self._vehicle.now, acknowledged=True)

    def _stopped(self, event: LogStreamStopped) -> None:
        if self._writer is not None:
            self._logs.streams.remove(self._writer)
        self._writer = None

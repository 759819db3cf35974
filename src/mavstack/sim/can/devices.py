"""The devices on the CAN bus of a simulated ArduPilot vehicle: the autopilot, a GPS receiver, an ESC.

They are there while a client has the bus forwarded: otherwise no client sees them.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.services.can import CanFrameReceived, CanServer
from mavstack.sim.can.dronecan import DroneCanNode

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.services.can import CanFrame
    from mavstack.sim.vehicle import SimulatedVehicle

STATUS_INTERVAL: Final = 1.0
_BUS: Final = 1
#: The nodes by their ids: the name, and the parameters.
_NODES: Final[Mapping[int, tuple[str, Mapping[str, int]]]] = MappingProxyType(
    {
        10: ("org.ardupilot:0", {}),
        42: ("org.mavstack.gps", {"GPS_RATE_HZ": 5, "GPS_DYNAMICS": 7}),
        43: ("org.mavstack.esc", {"ESC_INDEX": 0, "MOTOR_POLES": 14}),
    }
)


class CanDevices:
    """The nodes on the bus; a periodic check of the autopilot drives them."""

    def __init__(self, vehicle: SimulatedVehicle) -> None:
        self._vehicle = vehicle
        self._server = vehicle.engine.add(CanServer(vehicle.address))
        self._server.answer(vehicle.commands)
        self.nodes = [
            DroneCanNode(
                number,
                name,
                vehicle.serial.ljust(15, b"\0")[:15] + bytes((number,)),
                vehicle.now,
                dict(parameters),
            )
            for number, (name, parameters) in _NODES.items()
        ]
        self._due = vehicle.now
        vehicle.on_event(CanFrameReceived, self._received)
        vehicle.autopilot.watches.append(self)

    def tick(self, now: float) -> None:
        """Report the status of all nodes each second."""
        if now < self._due or not self._server.bus:
            return
        self._due = now + STATUS_INTERVAL
        for node in self.nodes:
            self._transmit(node.status_frames(now))

    def _received(self, event: CanFrameReceived) -> None:
        for node in self.nodes:
            self._transmit(node.answer(event.frame, self._vehicle.now))

    def _transmit(self, frames: list[CanFrame]) -> None:
        for frame in frames:
            self._server.transmit(_BUS, frame)
        if frames:
            self._vehicle.touch(self._server)

"""External vision on PX4: the bits of EKF2_EV_CTRL, in any frame of the world.

Times are converted by TIMESYNC, which the vehicle asks the sender for: an estimate that is older than
EKF2_DELAY_MAX is dropped, and one whose quality is below EKF2_EV_QMIN. After 0.2 s without one it is no
longer used. Without bit 0 of EKF2_GPS_CTRL the position does not come from GPS. Source: PX4, modules/mavlink
and modules/ekf2.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.services.timesync import TimesyncClient
from mavstack.sim.autopilot.external_vision import ExternalVision, VisionUse
from mavstack.sim.vehicle_types import VehicleType

if TYPE_CHECKING:
    from mavstack.dialects import Message
    from mavstack.services import Address
    from mavstack.services.parameters import Value
    from mavstack.sim.autopilot.external_vision import ExternalEstimate
    from mavstack.sim.vehicle import SimulatedVehicle

#: Maximum seconds between two estimates; after that, external estimates are no longer used.
TIMEOUT: Final = 0.2
_HORIZONTAL, _VERTICAL, _VELOCITY, _YAW = 1, 2, 4, 8
_GPS_CONTROL: Final = "EKF2_GPS_CTRL"
#: Maximum number of senders whose clocks are synchronized.
_MAX_CLOCKS: Final = 4


class VisionClocks:
    """The clocks of the senders of estimates."""

    def __init__(self, vehicle: SimulatedVehicle) -> None:
        self._vehicle = vehicle
        self._clients: dict[Address, TimesyncClient] = {}

    def age(self, time: float, source: Address) -> float:
        """Return the age of a measurement in seconds; 0 while the clock of its sender is not known."""
        client = self._clients.get(source)
        if client is None:
            if len(self._clients) < _MAX_CLOCKS:
                client = self._clients[source] = TimesyncClient(self._vehicle.address, source)
                self._vehicle.engine.add(client)
            return 0.0
        known = client.estimate
        return 0.0 if known is None else self._vehicle.now - (time - known.offset)


def register_external_vision(vehicle: SimulatedVehicle) -> None:
    """Use external vision as the parameters say, which may change at any time."""
    clocks, parameters, body = VisionClocks(vehicle), vehicle.parameters, vehicle.body

    def use_gps(control: Value) -> None:
        # A submarine always uses GPS, even if EKF2_GPS_CTRL disables it, because the simulation has no other
        # position source under water.
        body.use_gps(bool(int(control) & 1) or vehicle.vehicle_type is VehicleType.SUB)

    def accepts(message: Message, estimate: ExternalEstimate, source: Address) -> bool:
        if estimate.quality < int(parameters.get("EKF2_EV_QMIN", 0)):
            return False
        return clocks.age(estimate.time, source) <= float(parameters.get("EKF2_DELAY_MAX", 200.0)) / 1e3

    use_gps(parameters.get(_GPS_CONTROL, 1))
    parameters.on_change(_GPS_CONTROL, use_gps)
    vision = ExternalVision(vehicle, lambda: _use(vehicle), timeout=TIMEOUT, accepts=accepts)
    vehicle.autopilot.vision = vehicle.engine.add(vision)


def _use(vehicle: SimulatedVehicle) -> VisionUse:
    control = int(vehicle.parameters.get("EKF2_EV_CTRL", 0))
    return VisionUse(*(bool(control & bit) for bit in (_HORIZONTAL, _VERTICAL, _VELOCITY, _YAW)))

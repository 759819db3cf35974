"""All message producers of one vehicle, and their publication on its message server."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeAlias

from mavstack.services.message_request.interval import message_id_of
from mavstack.sim.telemetry.control_messages import ControlMessages
from mavstack.sim.telemetry.device_messages import DeviceMessages
from mavstack.sim.telemetry.distance_messages import DistanceMessages
from mavstack.sim.telemetry.motion_messages import MotionMessages
from mavstack.sim.telemetry.sensor_messages import SensorMessages
from mavstack.sim.telemetry.status_messages import StatusMessages
from mavstack.sim.telemetry.view import VehicleView

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.dialects import Message
    from mavstack.services.message_request.server import Producer
    from mavstack.sim.vehicle import SimulatedVehicle

MessageType: TypeAlias = "type[Message]"
Rates: TypeAlias = "Mapping[MessageType, float]"

#: Vehicles start their streams at different moments within this many seconds, so that the messages of a fleet
#: are not all due in the same step.
START_SPREAD = 0.25
#: The golden ratio, which places the start times of vehicles with successive system ids far apart.
_GOLDEN = 0.6180339887498949


class Producers:
    """Message producers of one boot, by subject."""

    def __init__(self, vehicle: SimulatedVehicle) -> None:
        self.view = view = VehicleView(vehicle)
        self.motion = MotionMessages(view)
        self.sensors = SensorMessages(view)
        self.distances = DistanceMessages(view)
        self.status = StatusMessages(view)
        self.control = ControlMessages(view)
        self.devices = DeviceMessages(view)


def publish_all(vehicle: SimulatedVehicle, producers: Mapping[MessageType, Producer], rates: Rates) -> None:
    """Publish each producer at its rate in hertz; messages without a rate are sent on request only."""
    first = vehicle.now + START_SPREAD * (vehicle.address.system * _GOLDEN % 1.0)
    for message_type, produce in producers.items():
        vehicle.messages.provide(
            message_type, produce, interval=interval_of(rates.get(message_type, 0.0)), now=first
        )
    vehicle.touch(vehicle.messages)


def change_rates(vehicle: SimulatedVehicle, rates: Rates) -> None:
    """Change the rates (hertz) of messages from now on."""
    for message_type, rate in rates.items():
        vehicle.messages.set_interval(message_type, interval_of(rate), vehicle.now)
    vehicle.touch(vehicle.messages)


def interval_of(rate: float) -> float:
    """Return the seconds between two messages; 0 for a rate of 0."""
    return 1.0 / rate if rate > 0 else 0.0


def message_ids(message_types: tuple[MessageType, ...]) -> frozenset[int]:
    """Return the message ids of classes."""
    return frozenset(message_id_of(message_type) for message_type in message_types)

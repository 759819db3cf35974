"""All producers of one vehicle's messages, and how they are handed to its message server."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeAlias

from mavstack.services.message_request.interval import message_id_of
from mavstack.sim.telemetry.control_messages import ControlMessages
from mavstack.sim.telemetry.motion_messages import MotionMessages
from mavstack.sim.telemetry.sensor_messages import SensorMessages
from mavstack.sim.telemetry.status_messages import StatusMessages
from mavstack.sim.telemetry.view import View

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.dialects import Message
    from mavstack.services.message_request.server import Producer
    from mavstack.sim.autopilot.interfaces import Vehicle

Kind: TypeAlias = "type[Message]"
Rates: TypeAlias = "Mapping[Kind, float]"

#: Vehicles begin their streams at different moments within so many seconds, so that a fleet's messages do not
#: all fall due in one step.
SPREAD = 0.25
#: A vehicle's share of the spread follows from its system id; no two neighbours are near each other.
_GOLDEN = 0.6180339887498949


class Producers:
    """One boot's producers, by what they look at."""

    def __init__(self, vehicle: Vehicle) -> None:
        self.view = view = View(vehicle)
        self.motion = MotionMessages(view)
        self.sensors = SensorMessages(view)
        self.status = StatusMessages(view)
        self.control = ControlMessages(view)


def provide_all(vehicle: Vehicle, producers: Mapping[Kind, Producer], rates: Rates) -> None:
    """Give a vehicle's server each producer, at its rate in hertz; those without one wait to be asked."""
    first = vehicle.now + SPREAD * (vehicle.address.system * _GOLDEN % 1.0)
    for kind, produce in producers.items():
        vehicle.messages.provide(kind, produce, interval=interval_of(rates.get(kind, 0.0)), now=first)
    vehicle.touch(vehicle.messages)


def change_rates(vehicle: Vehicle, rates: Rates) -> None:
    """Send kinds of messages at other rates from now on."""
    for kind, rate in rates.items():
        vehicle.messages.set_interval(kind, interval_of(rate), vehicle.now)
    vehicle.touch(vehicle.messages)


def interval_of(rate: float) -> float:
    """Seconds between two messages; 0 for a rate of 0."""
    return 1.0 / rate if rate > 0 else 0.0


def ids_of(kinds: tuple[Kind, ...]) -> frozenset[int]:
    """The message ids of classes."""
    return frozenset(message_id_of(kind) for kind in kinds)

"""The rows of the mapping table: each joins a name and a type of ROS with MAVLink, and is declared once.

A row stands beside its converter, in the module of its subject. Names are relative to the namespace of the
vehicle (`/mavros`); names that begin with a slash are absolute.
"""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Sequence
from dataclasses import dataclass
from enum import Enum
from operator import attrgetter
from typing import TYPE_CHECKING, Any, TypeAlias

from mavstack.bridges.core.qos import SENSOR, Qos
from mavstack.security.roles import Role

if TYPE_CHECKING:
    from mavstack.bridges.core.inbound import Inbound
    from mavstack.bridges.core.view import VehicleView
    from mavstack.dialects import Message
    from mavstack.vehicle import Vehicle

    MessageClass = type[Message]

#: The field values of a ROS message without its header, nested fields flattened.
Values: TypeAlias = Sequence[Any]
#: Returns the values for a message, or None if it does not have them. Periodic rows get None as the message.
Converter: TypeAlias = Callable[[Any, "VehicleView"], Values | None]
#: Returns the time of a message as Unix nanoseconds.
Stamp: TypeAlias = Callable[[Any, "VehicleView"], int]
#: Returns the MAVLink messages for the fields of a ROS message; raises `InvalidArgumentError` for bad ones.
Receiver: TypeAlias = Callable[[dict[str, Any], "Inbound"], Sequence["Message"]]
#: Answers a request with the fields of the response.
Handler: TypeAlias = Callable[["Vehicle", dict[str, Any], Any], Awaitable[dict[str, Any]]]


class Source(Enum):
    """The components whose messages a row takes."""

    AUTOPILOT = "autopilot"
    SYSTEM = "system"
    RADIO = "radio"


@dataclass(frozen=True, slots=True)
class Publication:
    """A topic from the vehicle.

    Attributes:
        name: The name of the topic.
        type: The full name of its type.
        sources: The messages that make it; empty: it is periodic, or other parts of the bridge publish it.
        convert: The converter; None: other parts of the bridge publish it.
        qos: The profile.
        frame: The name of a frame in `Frames` ("base_link", "map" …) for the header; empty: none.
        meaning: Units and frame, for the table.
        period: Seconds between two samples of a row without sources; 0: it is not periodic.
        difference: How it differs from MAVROS; empty: it does not.
        source: The components whose messages count.
    """

    name: str
    type: str
    sources: tuple[MessageClass, ...]
    convert: Converter | None
    qos: Qos = SENSOR
    frame: str = ""
    meaning: str = ""
    period: float = 0.0
    difference: str = ""
    source: Source = Source.AUTOPILOT


@dataclass(frozen=True, slots=True)
class Subscription:
    """A topic to the vehicle.

    Attributes:
        name: The name of the topic.
        type: The full name of its type.
        targets: The names of the messages that are sent.
        receive: Makes the messages.
        qos: The profile.
        role: The role that may use it.
        stream: The topic steers: samples that are late are refused.
        meaning: Units and frame, for the table.
        difference: How it differs from MAVROS; empty: it does not.
    """

    name: str
    type: str
    targets: tuple[MessageClass, ...]
    receive: Receiver
    qos: Qos = SENSOR
    role: Role = Role.OPERATE
    stream: bool = False
    meaning: str = ""
    difference: str = ""


@dataclass(frozen=True, slots=True)
class Service:
    """A service of the vehicle.

    Attributes:
        name: The name of the service.
        type: The full name of its type.
        handle: Answers a request; an error of Mavstack is answered by `refused`.
        role: The role that may use it.
        meaning: The MAVLink that it uses, for the table.
        difference: How it differs from MAVROS; empty: it does not.
        required: The fields that a request in JSON must have: their default values would act.
        required_unless: A field that makes all other required fields superfluous if it is true; empty: none.
    """

    name: str
    type: str
    handle: Handler
    role: Role = Role.OPERATE
    meaning: str = ""
    difference: str = ""
    required: tuple[str, ...] = ()
    required_unless: str = ""


@dataclass(frozen=True, slots=True)
class Action:
    """An action of the vehicle: a goal that takes a while, with feedback and a result.

    Attributes:
        name: The name of the action.
        type: The full name of its type.
        run: Flies to the goal; raises an error of Mavstack that holds the vehicle's reason.
        feedback: Returns the fields of the feedback.
        role: The role that may use it.
        meaning: The call, for the table.
        required: The fields that a goal in JSON must have; numbers that are left out are NaN.
    """

    name: str
    type: str
    run: Callable[[Vehicle, dict[str, Any]], Awaitable[None]]
    feedback: Callable[[Vehicle, dict[str, Any]], dict[str, Any]]
    role: Role = Role.OPERATE
    meaning: str = ""
    required: tuple[str, ...] = ()


Row: TypeAlias = Publication | Subscription | Service | Action


def fields(*names: str) -> Converter:
    """Return a converter that copies fields of a message, at least two."""
    get = attrgetter(*names)
    return lambda message, view: get(message)

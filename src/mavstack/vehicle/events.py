"""The events of a connection about vehicles, their payloads, and other ground stations.

async with connection.events(VehicleEvent) as events:
    async for event in events:
        print(event)
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from mavstack.services import Event

if TYPE_CHECKING:
    from mavstack.services.heartbeat import ComponentInfo, ConflictingSender
    from mavstack.vehicle.vehicle import Vehicle


@dataclass(frozen=True, slots=True)
class VehicleEvent(Event):
    """Base class of the events of a vehicle; `str(event)` is a text for people."""

    vehicle: Vehicle

    def __str__(self) -> str:
        return f"vehicle {self.vehicle.system} {self._text()}"

    def _text(self) -> str:
        return ""


@dataclass(frozen=True, slots=True)
class VehicleFound(VehicleEvent):
    """A vehicle's first heartbeat was received."""

    def _text(self) -> str:
        info = self.vehicle.component.info
        return f"found: {info.description if info else 'unknown'}"


@dataclass(frozen=True, slots=True)
class VehicleLost(VehicleEvent):
    """A vehicle was lost; `reason` is a text: "silent for 5 s", "its link … is closed"."""

    reason: str

    def _text(self) -> str:
        return f"lost: {self.reason}"


@dataclass(frozen=True, slots=True)
class VehicleReturned(VehicleEvent):
    """A lost vehicle returned after `after` seconds of silence."""

    after: float

    def _text(self) -> str:
        return f"returned after {self.after:.0f} s"


@dataclass(frozen=True, slots=True)
class VehicleRebooted(VehicleEvent):
    """A vehicle rebooted; the state cached from before is discarded."""

    def _text(self) -> str:
        return "rebooted"


@dataclass(frozen=True, slots=True)
class SystemIdConflict(VehicleEvent):
    """Two vehicles use one system id; emitted once, until the conflict ends.

    Attributes:
        senders: The known facts about each sender.
        differs: What tells them apart, such as "unique id" or "position".
    """

    senders: tuple[ConflictingSender, ...]
    differs: tuple[str, ...] = ()

    def _text(self) -> str:
        differs = f" (different: {', '.join(self.differs)})" if self.differs else ""
        return f"has a system id conflict: {'; '.join(map(str, self.senders))}{differs}"


@dataclass(frozen=True, slots=True)
class SystemIdConflictEnded(VehicleEvent):
    """Only one vehicle has used the system id for a while."""

    def _text(self) -> str:
        return "has its system id to itself again"


@dataclass(frozen=True, slots=True)
class SecondAutopilotFound(VehicleEvent):
    """A vehicle's system has another autopilot; commands go to the first one."""

    component: ComponentInfo

    def _text(self) -> str:
        return f"has a second autopilot: {_name(self.component)}"


@dataclass(frozen=True, slots=True)
class PayloadFound(VehicleEvent):
    """A vehicle has a payload: a camera, a gimbal, a companion computer or another component."""

    component: ComponentInfo

    def _text(self) -> str:
        return f"has {_name(self.component)}"


@dataclass(frozen=True, slots=True)
class PayloadLost(VehicleEvent):
    """A payload of a vehicle was lost; `reason` is a text."""

    component: ComponentInfo
    reason: str

    def _text(self) -> str:
        return f"lost {_name(self.component)}: {self.reason}"


@dataclass(frozen=True, slots=True)
class PayloadReturned(VehicleEvent):
    """A lost payload of a vehicle returned after `after` seconds of silence."""

    component: ComponentInfo
    after: float

    def _text(self) -> str:
        return f"has {_name(self.component)} again after {self.after:.0f} s"


@dataclass(frozen=True, slots=True)
class GroundStationFound(Event):
    """The first heartbeat of another ground station was received."""

    component: ComponentInfo

    def __str__(self) -> str:
        return f"another ground station: {self.component.address}"


@dataclass(frozen=True, slots=True)
class GroundStationLost(Event):
    """Another ground station was lost; `reason` is a text."""

    component: ComponentInfo
    reason: str

    def __str__(self) -> str:
        return f"ground station {self.component.address} lost: {self.reason}"


@dataclass(frozen=True, slots=True)
class GroundStationReturned(Event):
    """Another ground station returned after `after` seconds of silence."""

    component: ComponentInfo
    after: float

    def __str__(self) -> str:
        return f"ground station {self.component.address} returned after {self.after:.0f} s"


def _name(info: ComponentInfo) -> str:
    return f"{info.description} {info.address}"

"""The life of a connection: vehicles appear, fall silent, return and reboot, and who else is on the network.

    async with node.events(VehicleEvent) as events:
        async for event in events:
            print(event)

The node below tells of components; here that becomes what it means for vehicles:

- A vehicle is a system with an autopilot, whatever the autopilot's component id. If a system has two, the one
  heard first is the vehicle; the other one is told as `SecondAutopilotFound` and stays a component of it, and
  never takes its place by itself: who flies must know whom.
- A vehicle stays the same object when it is lost and returns. It is lost after some seconds of silence, or at
  once when the last link to it is closed; what is under way then ends in its typed error or goes on if it
  returns.
- At a reboot, parameters, mode and progress of the mission that were remembered are forgotten; what is under
  way begins anew or ends in its typed error.
- Two vehicles with one system id are told once, not as a row of reboots. What is sent to that id reaches
  both, and what is told of it is a mixture: nothing should be flown before one of them has another id.
- Cameras, gimbals, companion computers and the like with a vehicle's system id are its payloads, told once
  the vehicle is known. Other ground stations are told, wherever they are; so is who uses our own address,
  whose answers we might take for ours.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from mavstack.services import Event
from mavstack.services.heartbeat import (
    AddressClash,
    AddressClashOver,
    Claim,
    ComponentChanged,
    ComponentFound,
    ComponentInfo,
    ComponentLost,
    ComponentRebooted,
    ComponentReturned,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from mavstack.services import Address
    from mavstack.vehicle.vehicle import Vehicle


@dataclass(frozen=True, slots=True)
class VehicleEvent(Event):
    """Base of what happens to a vehicle; its text is for people."""

    vehicle: Vehicle

    def __str__(self) -> str:
        return f"vehicle {self.vehicle.system} {self._text()}"

    def _text(self) -> str:
        return ""


@dataclass(frozen=True, slots=True)
class VehicleFound(VehicleEvent):
    """A vehicle was heard for the first time."""

    def _text(self) -> str:
        info = self.vehicle.component.info
        return f"found: {info.kind if info else 'nothing is known of it'}"


@dataclass(frozen=True, slots=True)
class VehicleLost(VehicleEvent):
    """A vehicle is heard no more; `reason` says why: "silent for 5 s", "its link … is closed"."""

    reason: str

    def _text(self) -> str:
        return f"lost: {self.reason}"


@dataclass(frozen=True, slots=True)
class VehicleReturned(VehicleEvent):
    """A lost vehicle is heard again, `after` so many seconds of silence."""

    after: float

    def _text(self) -> str:
        return f"is back after {self.after:.0f} s"


@dataclass(frozen=True, slots=True)
class VehicleRebooted(VehicleEvent):
    """A vehicle started anew: what was remembered of it is forgotten."""

    def _text(self) -> str:
        return "rebooted"


@dataclass(frozen=True, slots=True)
class SystemIdConflict(VehicleEvent):
    """Two vehicles have one system id; `claims` is what is known of each. Told once until it is over."""

    claims: tuple[Claim, ...]

    def _text(self) -> str:
        return f"is two, which have the same system id: {'; '.join(map(str, self.claims))}"


@dataclass(frozen=True, slots=True)
class SystemIdConflictOver(VehicleEvent):
    """Only one vehicle was heard with the system id for a while."""

    def _text(self) -> str:
        return "is alone with its system id again"


@dataclass(frozen=True, slots=True)
class SecondAutopilotFound(VehicleEvent):
    """A vehicle's system has another autopilot; commands go to the first one."""

    component: ComponentInfo

    def _text(self) -> str:
        return f"has a second autopilot: {_named(self.component)}"


@dataclass(frozen=True, slots=True)
class PayloadFound(VehicleEvent):
    """A camera, a gimbal, a companion computer or the like is on a vehicle."""

    component: ComponentInfo

    def _text(self) -> str:
        return f"has {_named(self.component)}"


@dataclass(frozen=True, slots=True)
class PayloadLost(VehicleEvent):
    """A payload of a vehicle is heard no more."""

    component: ComponentInfo
    reason: str

    def _text(self) -> str:
        return f"lost {_named(self.component)}: {self.reason}"


@dataclass(frozen=True, slots=True)
class PayloadReturned(VehicleEvent):
    """A lost payload of a vehicle is heard again."""

    component: ComponentInfo
    after: float

    def _text(self) -> str:
        return f"has {_named(self.component)} again after {self.after:.0f} s"


@dataclass(frozen=True, slots=True)
class GroundStationFound(Event):
    """Another ground station was heard for the first time."""

    component: ComponentInfo

    def __str__(self) -> str:
        return f"another ground station: {self.component.address}"


@dataclass(frozen=True, slots=True)
class GroundStationLost(Event):
    """Another ground station is heard no more."""

    component: ComponentInfo
    reason: str

    def __str__(self) -> str:
        return f"ground station {self.component.address} lost: {self.reason}"


@dataclass(frozen=True, slots=True)
class GroundStationReturned(Event):
    """Another ground station is heard again."""

    component: ComponentInfo
    after: float

    def __str__(self) -> str:
        return f"ground station {self.component.address} is back after {self.after:.0f} s"


class VehicleTracker:
    """Turns what happens to components into what happens to vehicles."""

    def __init__(
        self, components: Mapping[Address, ComponentInfo], make: Callable[[Address], Vehicle]
    ) -> None:
        #: By system id, in the order in which they were found.
        self.vehicles: dict[int, Vehicle] = {}
        self._components = components
        self._make = make

    def follow(self, event: object) -> Iterator[Event]:
        """What an event of a component means."""
        match event:
            case ComponentFound(info):
                yield from self._found(info)
            case ComponentChanged(info, before):
                if (info.is_autopilot, info.is_ground_station) != (
                    before.is_autopilot,
                    before.is_ground_station,
                ):
                    yield from self._found(info)
            case ComponentLost(info, reason):
                yield from self._lost(info, reason)
            case ComponentReturned(info, after):
                yield from self._returned(info, after)
            case ComponentRebooted(info):
                yield from (VehicleRebooted(vehicle) for vehicle in self._flown_by(info))
            case AddressClash(info, claims):
                yield from (SystemIdConflict(vehicle, claims) for vehicle in self._flown_by(info))
            case AddressClashOver(info):
                yield from (SystemIdConflictOver(vehicle) for vehicle in self._flown_by(info))

    def _found(self, info: ComponentInfo) -> Iterator[Event]:
        system = info.address.system
        vehicle = self.vehicles.get(system)
        if vehicle is not None and vehicle.address == info.address:
            return
        if info.is_ground_station:
            yield GroundStationFound(info)
        elif vehicle is not None:
            yield (SecondAutopilotFound if info.is_autopilot else PayloadFound)(vehicle, info)
        elif info.is_autopilot:
            vehicle = self.vehicles[system] = self._make(info.address)
            yield VehicleFound(vehicle)
            for other in self._components.values():
                if other.address.system == system and not (other.is_autopilot or other.is_ground_station):
                    yield PayloadFound(vehicle, other)

    def _lost(self, info: ComponentInfo, reason: str) -> Iterator[Event]:
        for vehicle in self._flown_by(info):
            yield VehicleLost(vehicle, reason)
        for vehicle in self._carrying(info):
            yield PayloadLost(vehicle, info, reason)
        if info.is_ground_station:
            yield GroundStationLost(info, reason)

    def _returned(self, info: ComponentInfo, after: float) -> Iterator[Event]:
        for vehicle in self._flown_by(info):
            yield VehicleReturned(vehicle, after)
        for vehicle in self._carrying(info):
            yield PayloadReturned(vehicle, info, after)
        if info.is_ground_station:
            yield GroundStationReturned(info, after)

    def _flown_by(self, info: ComponentInfo) -> list[Vehicle]:
        """The vehicle whose autopilot this is, if there is one."""
        vehicle = self.vehicles.get(info.address.system)
        return [vehicle] if vehicle is not None and vehicle.address == info.address else []

    def _carrying(self, info: ComponentInfo) -> list[Vehicle]:
        """The vehicle whose payload this is, if there is one."""
        vehicle = self.vehicles.get(info.address.system)
        is_other = info.is_autopilot or info.is_ground_station
        return [vehicle] if vehicle is not None and vehicle.address != info.address and not is_other else []


def _named(info: ComponentInfo) -> str:
    return f"{info.kind} {info.address}"

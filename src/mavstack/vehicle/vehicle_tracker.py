"""The tracker of vehicles: turns the events of components into events of vehicles.

- A vehicle is a system with an autopilot, whatever the autopilot's component id. If a system has two, the one
  heard first is the vehicle. The other one is reported as `SecondAutopilotFound` and stays a component of the
  vehicle; it never replaces the first by itself, so that commands go to a known autopilot.
- A vehicle stays the same object when it is lost and returns. It is lost after some seconds of silence, or at
  once when its last link is closed; operations that are under way then end in their typed errors, or go on if
  it returns.
- After a reboot the cached parameters, mode and mission progress are discarded; operations that are under way
  start again or end in their typed errors.
- Two vehicles with one system id are reported once, not as a series of reboots. Its telemetry is a mixture,
  and every call that acts is refused, until `choose_sender` chooses one, or one of them gets another id.
- Cameras, gimbals, companion computers and other components with a vehicle's system id are its payloads,
  reported once the vehicle is known. Other ground stations are reported, whatever their system id; so is
  another sender with the node's own address (`OwnAddressConflict`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.services.heartbeat import (
    AddressConflict,
    AddressConflictEnded,
    ComponentChanged,
    ComponentFound,
    ComponentInfo,
    ComponentLost,
    ComponentRebooted,
    ComponentReturned,
)
from mavstack.vehicle.events import (
    GroundStationFound,
    GroundStationLost,
    GroundStationReturned,
    PayloadFound,
    PayloadLost,
    PayloadReturned,
    SecondAutopilotFound,
    SystemIdConflict,
    SystemIdConflictEnded,
    VehicleFound,
    VehicleLost,
    VehicleRebooted,
    VehicleReturned,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from mavstack.services import Address, Event
    from mavstack.vehicle.vehicle import Vehicle


class VehicleTracker:
    """Tracks the vehicles among the components of a node."""

    def __init__(
        self, components: Mapping[Address, ComponentInfo], make_vehicle: Callable[[Address], Vehicle]
    ) -> None:
        #: The vehicles by system id, in the order in which they were found.
        self.vehicles: dict[int, Vehicle] = {}
        self._components = components
        self._make_vehicle = make_vehicle
        #: The components whose event ComponentFound was received; `components` may already hold others.
        self._found_addresses: set[Address] = set()

    def receive(self, event: object) -> Iterator[Event]:
        """Yield the vehicle events that follow from an event of a component."""
        match event:
            case ComponentFound(info):
                self._found_addresses &= self._components.keys()
                self._found_addresses.add(info.address)
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
                for vehicle in self._with_autopilot(info):
                    vehicle.telemetry.rebooted_at = vehicle.telemetry.now()
                    yield VehicleRebooted(vehicle)
            case AddressConflict(info, senders, differs):
                yield from (
                    SystemIdConflict(vehicle, senders, differs) for vehicle in self._with_autopilot(info)
                )
            case AddressConflictEnded(info):
                yield from (SystemIdConflictEnded(vehicle) for vehicle in self._with_autopilot(info))

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
            vehicle = self.vehicles[system] = self._make_vehicle(info.address)
            yield VehicleFound(vehicle)
            for other in self._components.values():
                is_payload = not (other.is_autopilot or other.is_ground_station)
                if other.address.system == system and is_payload and other.address in self._found_addresses:
                    yield PayloadFound(vehicle, other)

    def _lost(self, info: ComponentInfo, reason: str) -> Iterator[Event]:
        for vehicle in self._with_autopilot(info):
            yield VehicleLost(vehicle, reason)
        for vehicle in self._with_payload(info):
            yield PayloadLost(vehicle, info, reason)
        if info.is_ground_station:
            yield GroundStationLost(info, reason)

    def _returned(self, info: ComponentInfo, after: float) -> Iterator[Event]:
        for vehicle in self._with_autopilot(info):
            yield VehicleReturned(vehicle, after)
        for vehicle in self._with_payload(info):
            yield PayloadReturned(vehicle, info, after)
        if info.is_ground_station:
            yield GroundStationReturned(info, after)

    def _with_autopilot(self, info: ComponentInfo) -> list[Vehicle]:
        """Return the vehicle that has this autopilot, in a list; empty if there is none."""
        vehicle = self.vehicles.get(info.address.system)
        return [vehicle] if vehicle is not None and vehicle.address == info.address else []

    def _with_payload(self, info: ComponentInfo) -> list[Vehicle]:
        """Return the vehicle that carries this payload, in a list; empty if there is none."""
        vehicle = self.vehicles.get(info.address.system)
        is_other = info.is_autopilot or info.is_ground_station
        return [vehicle] if vehicle is not None and vehicle.address != info.address and not is_other else []

"""The view of a vehicle that firmware classes need: its identity, its reports and its commands."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from mavstack.node.component import RemoteComponent
    from mavstack.node.params import Params
    from mavstack.services import Address
    from mavstack.services.version import AutopilotVersion
    from mavstack.vehicle.vehicle_type import VehicleType


class FirmwareVehicle(Protocol):
    """A vehicle as firmware classes see it; `vehicle.VehicleState` is the implementation."""

    @property
    def address(self) -> Address:
        """The address of its autopilot."""
        ...

    @property
    def autopilot(self) -> int:
        """The MAV_AUTOPILOT of its heartbeat."""
        ...

    @property
    def identifier(self) -> str:
        """The identifier of a firmware that speaks MSP, such as "BTFL"; empty for all others."""
        ...

    @property
    def component(self) -> RemoteComponent:
        """Its autopilot, which takes the commands."""
        ...

    @property
    def params(self) -> Params:
        """Its parameters."""
        ...

    @property
    def vehicle_type(self) -> VehicleType:
        """The way it moves."""
        ...

    @property
    def vtol_state(self) -> int | None:
        """The MAV_VTOL_STATE; None if it is not known."""
        ...

    @property
    def version(self) -> AutopilotVersion | None:
        """The versions; None if they were not requested."""
        ...

    @property
    def mode(self) -> str | None:
        """The name of its flight mode; None if it is not known."""
        ...

    @property
    def armed(self) -> bool | None:
        """True if the motors may run; None if that is not known."""
        ...

    @property
    def in_air(self) -> bool | None:
        """True if it flies; None if that is not known."""
        ...

    @property
    def heading(self) -> float | None:
        """The heading in degrees clockwise from north; None if it is not known."""
        ...

    def rc_pulse(self, channel: int) -> int | None:
        """Return the pulse of a radio control channel in microseconds; None if there is none."""
        ...

    async def get_home_altitude(self) -> float:
        """Return the altitude of home in metres above mean sea level; request it if it is not known."""
        ...

    async def get_relative_altitude(self) -> float:
        """Return the present altitude in metres above home; wait until it is received."""
        ...

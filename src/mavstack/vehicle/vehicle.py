"""A vehicle: what it tells, and what it can be asked to do.

Everything here goes through its autopilot, the component that flies it; `component` is that one with every
service of MAVLink, for what is not here.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mavstack.node import RemoteComponent
    from mavstack.node.files import Files
    from mavstack.node.logs import Logs
    from mavstack.node.parameters import Parameters
    from mavstack.node.plans import Plans
    from mavstack.node.shell import Shell
    from mavstack.services import Address
    from mavstack.vehicle.connection import Connection


class Vehicle:
    """One vehicle; made by `Connection.vehicle` and `Connection.vehicles`."""

    def __init__(self, node: Connection, component: RemoteComponent) -> None:
        self.node = node
        #: Its autopilot, with every service of MAVLink.
        self.component = component

    @property
    def address(self) -> Address:
        """The address of its autopilot."""
        return self.component.address

    @property
    def system(self) -> int:
        """Its system id."""
        return self.address.system

    @property
    def params(self) -> Parameters:
        """Its parameters."""
        return self.component.parameters

    @property
    def mission(self) -> Plans:
        """What it is to fly."""
        return self.component.mission

    @property
    def fence(self) -> Plans:
        """Where it must stay."""
        return self.component.fence

    @property
    def rally(self) -> Plans:
        """Where it may land when it returns."""
        return self.component.rally

    @property
    def ftp(self) -> Files:
        """The files on it."""
        return self.component.files

    @property
    def logs(self) -> Logs:
        """The logs on it."""
        return self.component.logs

    def shell(self) -> Shell:
        """Open its shell while a block lasts."""
        return self.component.shell()

    def __repr__(self) -> str:
        return f"<Vehicle {self.address}>"

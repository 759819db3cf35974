"""The clients of one remote component, each created on first use."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any

from mavstack.node.firmware import has_home_item_first
from mavstack.services import Address
from mavstack.services.camera import CameraMonitor
from mavstack.services.command import CommandClient
from mavstack.services.events import EventReceiver
from mavstack.services.extended_parameters import ExtendedParameterClient
from mavstack.services.ftp import FtpClient
from mavstack.services.gimbal import GimbalMonitor
from mavstack.services.log import LogClient
from mavstack.services.mission import MissionClient
from mavstack.services.modes import ModeMonitor
from mavstack.services.parameters import ParameterClient
from mavstack.services.ping import PingClient
from mavstack.services.signing_setup import SigningSetupClient
from mavstack.services.terrain import TerrainCheckClient
from mavstack.services.timesync import TimesyncClient

if TYPE_CHECKING:
    from mavstack.node.host import NodeHost
    from mavstack.security import SigningKey
    from mavstack.services import Operation
    from mavstack.services.heartbeat import ComponentInfo


class ComponentClients:
    """The clients of one remote component; the parts of the component share the clients."""

    def __init__(self, host: NodeHost, address: Address) -> None:
        self.host = host
        self.address = address

    @property
    def info(self) -> ComponentInfo | None:
        """The component's last heartbeat; None if none was received."""
        return self.host.components.get(self.address)

    def has(self, name: str) -> bool:
        """Return whether the client of that name was created."""
        return name in self.__dict__

    def clear_cache(self) -> None:
        """Discard the state that the clients cached before a reboot of the component."""
        now = self.host.now()
        for name in ("params", "extended_params"):
            if self.has(name):
                client = getattr(self, name)
                client.clear_cache(now)
                self.host.wake(client)
        if self.has("modes"):
            self.modes.clear_cache()
        for name in ("cameras", "gimbals"):
            if self.has(name):
                getattr(self, name).clear_cache()
        if self.has("mission"):
            self.mission.clear_progress()

    def sibling(self, component: int) -> ComponentClients:
        """Return the clients of another component of the same system."""
        return ComponentClients(self.host, Address(self.address.system, component))

    @cached_property
    def cameras(self) -> CameraMonitor:
        """The monitor of the component's cameras, from the first use on."""
        return self.host.serve(CameraMonitor(self.host.address, self.address, self._begin_command))

    @cached_property
    def gimbals(self) -> GimbalMonitor:
        """The monitor of the component's gimbals, from the first use on."""
        return self.host.serve(GimbalMonitor(self.host.address, self.address))

    def _begin_command(self, operation: Operation[Any], now: float) -> None:
        self.command.begin(operation, now)
        self.host.engine.touch(self.command)

    @cached_property
    def command(self) -> CommandClient:
        """The client of every command."""
        return self.host.serve(CommandClient(self.host.address, self.address))

    @cached_property
    def params(self) -> ParameterClient:
        """The client of the parameter protocol."""
        return self.host.serve(ParameterClient(self.host.address, self.address))

    @cached_property
    def extended_params(self) -> ExtendedParameterClient:
        """The client of the extended parameter protocol."""
        return self.host.serve(ExtendedParameterClient(self.host.address, self.address))

    @cached_property
    def ftp(self) -> FtpClient:
        """The client of MAVLink FTP."""
        return self.host.serve(FtpClient(self.host.address, self.address))

    @cached_property
    def logs(self) -> LogClient:
        """The client of the log protocol."""
        return self.host.serve(LogClient(self.host.address, self.address))

    @cached_property
    def mission(self) -> MissionClient:
        """The client of the mission protocol, for all plan types."""
        home_first = has_home_item_first(self.info)
        return self.host.serve(MissionClient(self.host.address, self.address, home_first=home_first))

    @cached_property
    def modes(self) -> ModeMonitor:
        """The monitor that follows the mode from the first use on."""
        return self.host.serve(ModeMonitor(self.host.address, self.address))

    @cached_property
    def events(self) -> EventReceiver:
        """The receiver of the component's events, from the first use on."""
        return self.host.serve(EventReceiver(self.host.address, self.address))

    @cached_property
    def ping(self) -> PingClient:
        """The client of the ping protocol."""
        return self.host.serve(PingClient(self.host.address, self.address))

    @cached_property
    def terrain(self) -> TerrainCheckClient:
        """The client that checks the terrain of a vehicle."""
        return self.host.serve(TerrainCheckClient(self.host.address, self.address))

    @cached_property
    def signing(self) -> SigningSetupClient:
        """The client that installs signing keys."""
        engine = self.host.engine
        return self.host.serve(
            SigningSetupClient(
                self.host.address,
                self.address,
                key_refusal=engine.key_channels.refusal,
                arrived_elsewhere=engine.arrived_elsewhere,
            )
        )

    async def setup_signing(self, key: SigningKey | None, channel: str | None, timeout: float | None) -> None:
        """Install a signing key; `channel` is the name of the channel for a first key."""
        client, key_channels = self.signing, self.host.engine.key_channels
        if channel is not None and key is not None:
            key_channels.name(self.address, channel)
        try:
            await self.host.finish(client, client.install(key, self.host.now(), timeout=timeout))
        finally:
            if not client.changing:
                key_channels.release(self.address)

    @cached_property
    def clock(self) -> TimesyncClient:
        """The client that follows the component's clock from the first use on."""
        return self.host.serve(TimesyncClient(self.host.address, self.address))

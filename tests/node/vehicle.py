"""A component that offers every service, on a node over a memory link, for tests of clients."""

from __future__ import annotations

from mavstack.dialects import common
from mavstack.links import MemoryNetwork
from mavstack.node import Node
from mavstack.services.extended_parameters import ExtendedParameterServer
from mavstack.services.ftp import FtpServer, MemoryStore
from mavstack.services.log import LogEntry, LogServer
from mavstack.services.manual_control import ManualControlReceiver
from mavstack.services.mission import MissionServer
from mavstack.services.modes import ModeChanged, ModeServer, modes_of
from mavstack.services.parameters import Encoding, ParameterServer
from mavstack.services.serial_control import ShellInput, ShellServer
from mavstack.services.setpoints import SetpointReceiver
from mavstack.services.version import AutopilotVersion, FirmwareVersion, provide_versions

COPTER = common.MavType.QUADROTOR
CAN = common.MavProtocolCapability


class MemoryLogs:
    """Logs in memory."""

    def __init__(self) -> None:
        self.contents = {1: bytes(range(256)) * 40, 2: b"short"}

    def logs(self):
        return [LogEntry(number, 1_700_000_000, len(data)) for number, data in self.contents.items()]

    def read(self, number, offset, count, /):
        return self.contents[number][offset : offset + count]

    def erase(self):
        self.contents.clear()


class Vehicle(Node):
    """A vehicle that offers every service."""

    def __init__(self, *links, system: int = 1, autopilot: int = common.MavAutopilot.PX4) -> None:
        super().__init__(*links, system=system, component=1, type=COPTER, autopilot=autopilot)
        bytewise = autopilot == common.MavAutopilot.PX4
        encoding = Encoding.BYTEWISE if bytewise else Encoding.C_CAST
        self.parameters = self.serve(ParameterServer(self.address, encoding))
        for number in range(40):
            self.parameters.add(f"P_{number:02}", number)
        self.logs = MemoryLogs()
        self.serve(LogServer(self.address, self.logs))
        self.mission = self.serve(MissionServer(self.address))
        modes = modes_of(autopilot, COPTER, MODES[autopilot])  # type: ignore[index]
        self.modes = self.serve(ModeServer(self.address, modes, 0, autopilot=autopilot))
        self.modes.register(self.commands.server)
        self.files = MemoryStore(
            {"logs/flight.bin": bytes(range(256)) * 200, "hello.txt": b"hello"},
            {"@PARAM/param.pck": self.parameters.table.packed},
        )
        self.ftp = self.serve(FtpServer(self.address, self.files))
        self.extended = self.serve(ExtendedParameterServer(self.address))
        self.extended.add("CAM_MODE", "photo")
        self.shell = self.serve(ShellServer(self.address))
        self.setpoints = self.serve(SetpointReceiver(self.address))
        self.sticks = self.serve(ManualControlReceiver(self.address))
        capabilities = CAN.PARAM_ENCODE_BYTEWISE if bytewise else CAN.PARAM_ENCODE_C_CAST | CAN.FTP
        provide_versions(
            self.message_server,
            AutopilotVersion(capabilities=capabilities, flight=FirmwareVersion(1, 2, 3, 255)),
        )

    def _on_event(self, event, service=None) -> None:
        super()._on_event(event, service)
        match event:
            case ModeChanged():
                self._heartbeat.custom_mode = self.modes.current.custom_mode
                self._heartbeat.send_now(self.now())
                self.wake(self._heartbeat)
            case ShellInput(data=data):
                self.shell.feed(b"echo: " + data)
                self.wake(self.shell)


MODES = {
    common.MavAutopilot.PX4: [0, 0x04040000, 0x05040000],
    common.MavAutopilot.ARDUPILOTMEGA: [0, 4, 6],
}


class VehiclePair:
    """A ground station and a vehicle."""

    def __init__(self, **options) -> None:
        network = MemoryNetwork()
        self.ground = Node(network.link())
        self.vehicle = Vehicle(network.link(), **options)

    async def __aenter__(self):
        await self.ground.open()
        await self.vehicle.open()
        self.remote = await self.ground.wait_for_autopilot()
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.vehicle.close()
        await self.ground.close()

"""A simulated vehicle as a MAVLink component: its services, and the autopilot that they drive.

It needs no event loop and no clock: bytes enter through `receive`, time through `step`, and `data_to_send`
returns the bytes to send. Requests of clients reach the autopilot as events of the services (`on_event`).

    vehicle = simulation.add(VehicleType.COPTER, Firmware.ARDUPILOT)
    port = vehicle.open_port("ground")
    vehicle.receive(port, data)
    for port, data in vehicle.data_to_send(): ...

A reboot creates new services and a new autopilot; ports, keys, parameters, plans, files and the body stay. A
power cycle is a reboot that also loses the parameters that were not saved.
"""

from __future__ import annotations

import logging
from collections import defaultdict
from typing import TYPE_CHECKING, Any, TypeVar

from mavstack.dialects import Dialect, common
from mavstack.services.mission import PlanStore
from mavstack.sim.autopilot.autopilot import SimulatedAutopilot
from mavstack.sim.autopilot.ticks import TICK
from mavstack.sim.faults import Faults
from mavstack.sim.payloads import SimulatedCamera, SimulatedGimbal
from mavstack.sim.port import Port
from mavstack.sim.recorder import Recorder
from mavstack.sim.remote_id import RemoteIdModule
from mavstack.sim.services import Services
from mavstack.sim.signing_keys import SigningKeys
from mavstack.sim.storage import Storage
from mavstack.sim.transponder import SimulatedTransponder

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from mavstack.links.settings import Version
    from mavstack.security import SigningKey
    from mavstack.services import Address, Event, Service
    from mavstack.services.terrain import TerrainMap
    from mavstack.sim.autopilot.firmware_profile import FirmwareProfile, Mode
    from mavstack.sim.motion import Body
    from mavstack.sim.parameters import Parameters
    from mavstack.sim.rangefinders import Rangefinder
    from mavstack.sim.vehicle_types import Firmware, VehicleType
    from mavstack.wire import Packet

AnyEvent = TypeVar("AnyEvent", bound="Event")

_LOG = logging.getLogger("mavstack.sim")

#: Seconds for which a rebooting vehicle sends nothing.
REBOOT_SILENCE = 1.0
MAX_SYSTEM_ID = 255


class SimulatedVehicle:
    """One simulated vehicle; `Simulation.add` creates it.

    Attributes:
        vehicle_type: The vehicle type.
        firmware: The firmware.
        address: System and component id.
        autopilot: The autopilot, new at each boot.
        parameters: The parameters.
        plans: The stored mission, fence and rally points.
        faults: The injected faults.
        body: The physical body: true motion, estimate, sensors.
        rangefinders: The chosen rangefinders; empty for those of the firmware's default.
        proximity: True if the vehicle has a proximity sensor.
        has_remote_id: True if the vehicle has a Remote ID module.
        has_transponder: True if the vehicle has an ADS-B transponder.
        terrain: The terrain that the vehicle has from ground stations; None: it knows the flat ground.
        serial: The unique id of the board, eight bytes.
    """

    #: This vehicle speaks MAVLink.
    speaks_msp = False

    def __init__(
        self,
        body: Body,
        vehicle_type: VehicleType,
        firmware: Firmware,
        address: Address,
        profile: FirmwareProfile,
        parameters: Parameters,
        *,
        now: float,
        folder: Path | None = None,
        camera: bool = False,
        gimbal: bool = False,
        rangefinders: Sequence[Rangefinder] = (),
        proximity: bool = False,
        terrain: TerrainMap | None = None,
        remote_id: bool = False,
        transponder: bool = False,
        serial: bytes = b"Mavstack",
    ) -> None:
        self.body, self.vehicle_type, self.firmware, self.address = body, vehicle_type, firmware, address
        self.profile = profile
        #: The id of the simulated board, which has a bootloader; None if the firmware runs as a program on a
        #: computer.
        self.board_id: int | None = None
        self.rangefinders: Sequence[Rangefinder] = tuple(rangefinders)
        self.proximity, self.terrain, self.serial = proximity, terrain, serial
        self.has_remote_id, self.has_transponder = remote_id, transponder
        self.parameters = parameters
        self.plans = PlanStore()
        self.now = self.booted_at = now
        self.boots = 0
        #: Callbacks that get the vehicle, a kind ("text", "mode", "armed", "camera" or "signing") and a
        #: description.
        self.listeners: list[Callable[[SimulatedVehicle, str, str], None]] = []
        self.ports: list[Port] = []
        self.storage: Storage = Storage(self, folder=folder)
        self.recorder = Recorder(self)
        self.faults: Faults = Faults(self)
        self.signing_keys = SigningKeys(self)
        #: True while the links are cut in both directions.
        self.cut_off = False
        #: Data that was sent before a reboot or a cut of the links, for the next `data_to_send`.
        self._final_data: list[tuple[Port, bytes]] = []
        self._dialect = Dialect.load("all")
        self._silent_until = now
        #: The simulated gimbal and camera; None if the vehicle does not have them.
        self.gimbal = SimulatedGimbal(self) if gimbal else None
        self.camera = SimulatedCamera(self, self.gimbal) if camera else None
        self._boot()

    def _boot(self) -> None:
        self.boots += 1
        self.booted_at = self.now
        self._reactions: dict[type, list[Callable[[Any], None]]] = defaultdict(list)
        self._to_send: list[tuple[Port, bytes]] = []
        # Spread the ticks of many vehicles over time.
        self._tick_due = self.now + self.address.system % 5 * TICK / 5
        self.services = Services(self, self._dialect, self.signing_keys)
        self.engine = self.services.engine
        #: The ADS-B transponder; None if the vehicle has none.
        self.transponder = SimulatedTransponder(self) if self.has_transponder else None
        self.modes, self.commands = self.services.modes, self.services.commands
        self.messages, self.mission = self.services.messages, self.services.mission
        self.autopilot: SimulatedAutopilot = SimulatedAutopilot(self, self.profile)
        self.profile.register(self)
        self.profile.provide(self)
        #: The Remote ID module; None if the vehicle has none.
        self.remote_id = RemoteIdModule(self) if self.has_remote_id else None
        self._attach_payloads()
        self.profile.booted(self)
        for port in self.ports:
            self._connect(port)

    def _attach_payloads(self) -> None:
        if self.gimbal is not None:
            self.gimbal.attach()
        if self.camera is not None:
            if self.camera.address.system != self.address.system:
                self.camera = SimulatedCamera(self, self.gimbal)
            self.camera.attach()
            self.autopilot.payload.trigger = self.camera.capture

    # Ports

    def open_port(
        self,
        name: str,
        *,
        key: SigningKey | None = None,
        version: Version = 2,
        bandwidth: float | None = None,
        bulk_rate: float | None = None,
    ) -> Port:
        """Open a port for a peer.

        Args:
            name: The name of the peer, for logs.
            key: The signing key of the port, until one is set up on the vehicle; None for no signing.
            version: The MAVLink version of sent packets, 1, 2 or "auto".
            bandwidth: Bytes per second; None if unknown.
            bulk_rate: Packets of logs and files per second; None for no limit.

        Returns:
            The port.
        """
        capacity = {"bandwidth": bandwidth, "bulk_rate": bulk_rate}
        port = Port(name, self.signing_keys.key_of_port(key), {"version": version} | capacity)
        self.ports.append(port)
        self._connect(port)
        self.services.beacon.send_now(self.now)
        self.touch(self.services.beacon)
        return port

    def close_port(self, port: Port) -> None:
        """Close the port of a peer, and drop its pending data."""
        self.ports.remove(port)
        if port.state is not None:
            self.engine.close_channel(port.state)
        self._to_send = [item for item in self._to_send if item[0] is not port]
        self._final_data = [item for item in self._final_data if item[0] is not port]

    def _connect(self, port: Port) -> None:
        port.state = self.engine.open_channel(port.name, **port.options)
        self.signing_keys.sign(port)

    def receive(self, port: Port, data: bytes) -> list[Packet]:
        """Process data from a peer; returns the packets in it."""
        if port.state is None or self.cut_off or self.now < self._silent_until:
            return []
        packets = self.engine.receive(port.state, data, self.now)
        self._settle()
        return packets

    def data_to_send(self) -> list[tuple[Port, bytes]]:
        """Return the data sent since the last call, in order."""
        sent, self._final_data = self._final_data, []
        if self.now < self._silent_until:
            return sent
        self._settle()
        if not self.cut_off:
            sent += self._to_send
        self._to_send = []
        return sent

    # Periodic update and reboot

    def step(self, now: float) -> None:
        """Advance to the simulated Unix time `now`."""
        self.now = now
        if now < self._silent_until:
            return
        if now >= self._tick_due:
            self._tick_due += TICK
            self.autopilot.tick(now)
            self.parameters.tick(now)
            self.refresh_heartbeat()
            self.recorder.tick(now)
        due = self.engine.next_timeout()
        if due is not None and due <= now:
            self.engine.handle_timeout(now)
        self._settle()

    @property
    def equipment(self) -> list[str]:
        """Names of the payloads and of the chosen distance sensors."""
        payloads = {"camera": self.camera, "gimbal": self.gimbal}
        names = [name for name, payload in payloads.items() if payload is not None]
        names += [f"rangefinder {each.name}" for each in self.rangefinders]
        return names + ["proximity sensor"] * self.proximity

    @property
    def uptime(self) -> float:
        """Seconds since the last boot."""
        return self.now - self.booted_at

    @property
    def uptime_ms(self) -> int:
        """Milliseconds since the last boot, as in `time_boot_ms`."""
        return int(self.uptime * 1000) & 0xFFFFFFFF

    def reboot(self) -> None:
        """Restart the autopilot: motors off, a short silence, and the system id of the parameters."""
        self.flush_pending()
        self.body.stop()
        # Equal ids of two vehicles are allowed, as with real vehicles.
        if 0 < self.parameters.system <= MAX_SYSTEM_ID:
            self.address = self.address._replace(system=self.parameters.system)
        _LOG.info("vehicle %d reboots", self.address.system)
        self._boot()
        self._silent_until = self.now + REBOOT_SILENCE

    def reboot_into_bootloader(self) -> None:
        """Restart, and announce that a host may flash the board before the autopilot starts."""
        self.reboot()
        self.announce("bootloader", "waits in its bootloader")

    def power_cycle(self) -> None:
        """Take away the power for a moment: parameters that were not saved are lost."""
        self.parameters.revert_unsaved()
        self.reboot()

    def close(self) -> None:
        """Finish the current log."""
        self.storage.logs.end()

    def cut(self, off: bool) -> None:
        """Cut or restore all links; data sent before still arrives."""
        if off and not self.cut_off:
            self.flush_pending()
        self.cut_off = off

    def switch_transmitter(self, on: bool) -> bool:
        """Switch the pilot's transmitter on or off; returns whether the pilot has lost it."""
        radio = self.autopilot.radio
        radio.switch(on)
        return not on and radio.has_transmitter

    def flush_pending(self) -> None:
        """Keep the pending data, such as the acknowledgement of a reboot, for the next `data_to_send`."""
        self._settle()
        if not self.cut_off:
            self._final_data += self._to_send
        self._to_send = []

    # Interface for the components of the vehicle

    def add_listener(self, listener: Callable[[SimulatedVehicle, str, str], None]) -> None:
        """Call `listener(vehicle, kind, text)` on each event; adding it again has no effect."""
        if listener not in self.listeners:
            self.listeners.append(listener)

    def on_event(self, kind: type[AnyEvent], reaction: Callable[[AnyEvent], None]) -> None:
        """Call `reaction` with each event of a class from the services."""
        self._reactions[kind].append(reaction)

    def touch(self, service: Service) -> None:
        """Schedule a service whose method was called, so that its messages are sent."""
        self.engine.touch(service)

    def send_statustext(self, text: str, severity: int = common.MavSeverity.INFO) -> None:
        """Send a STATUSTEXT, and log it."""
        self.services.texts.send_text(self.profile.sent_text(text), severity)
        self.touch(self.services.texts)
        self.recorder.text(text, severity)
        self.announce("text", text)

    def mode_entered(self, mode: Mode, reason: str) -> None:
        """Publish that the autopilot entered a mode."""
        self.recorder.mode(mode.number, reason)
        self.announce("mode", f"mode {mode.name}")
        self.refresh_heartbeat()

    def armed_changed(self) -> None:
        """Publish that the vehicle was armed or disarmed, and begin or end a log."""
        self.recorder.armed(self.autopilot.armed)
        self.announce("armed", "armed" if self.autopilot.armed else "disarmed")
        self.refresh_heartbeat()

    def home_changed(self) -> None:
        """Publish the new home position."""
        self.recorder.home(self.autopilot.home)
        self.profile.home_changed(self)

    def refresh_heartbeat(self) -> None:
        """Send HEARTBEAT immediately if its content has changed."""
        self.services.refresh_heartbeat()

    def announce(self, kind: str, text: str) -> None:
        """Log an event, and call the listeners with it."""
        _LOG.debug("vehicle %d: %s", self.address.system, text)
        for listener in self.listeners:
            listener(self, kind, text)

    def _settle(self) -> None:
        while not self.engine.idle:
            for state, data in self.engine.data_to_send(self.now):
                port = self.services.port_of(state)
                if port is not None:
                    self._to_send.append((port, data))
            for _, event in self.engine.events():
                for reaction in self._reactions.get(type(event), ()):
                    reaction(event)

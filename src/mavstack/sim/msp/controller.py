"""A simulated flight controller that speaks MSP.

It needs no event loop and no clock: bytes enter through `receive`, time through `step`, and `data_to_send`
returns the bytes to send. Any number of peers have a port each.

    controller = simulation.add_flight_controller("betaflight")
    port = controller.open_port("configurator")
    controller.receive(port, data)
    for port, data in controller.data_to_send(): ...

The differences between Betaflight and iNav are in `System`. A reboot starts the firmware again
from the settings in the EEPROM, while ports and body stay. With a folder the EEPROM is the file
`eeprom.msp` there, and outlives the program.
"""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING, Final

from mavstack.atomic_file import write_file_atomically
from mavstack.sim.faults import Faults
from mavstack.sim.motion.readings import FIX_3D
from mavstack.sim.msp.cli_commands import CliCommands
from mavstack.sim.msp.firmwares import start_firmware
from mavstack.sim.msp.port import MspPort
from mavstack.sim.vehicle_types import ControllerFirmware, VehicleType

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from pathlib import Path

    from mavstack.msp.firmware_info import FirmwareInfo
    from mavstack.msp.frame import Frame
    from mavstack.services import Address
    from mavstack.sim.motion import Body

_LOG = logging.getLogger("mavstack.sim")

#: Seconds for which a rebooting controller sends nothing.
REBOOT_SILENCE: Final = 1.0
EEPROM_FILE: Final = "eeprom.msp"


class SimulatedFlightController:
    """One simulated flight controller; `Simulation.add_flight_controller` creates it.

    Attributes:
        vehicle_type: The vehicle type, a copter.
        firmware: The firmware.
        address: The number by which faults and events name the vehicle, as a system id.
        body: The physical body: true motion, estimate, sensors.
        faults: The injected faults.
        now: The time of the simulation.
        boots: Number of boots.
    """

    #: This vehicle speaks MSP instead of MAVLink.
    speaks_msp = True

    def __init__(
        self,
        body: Body,
        firmware: ControllerFirmware,
        address: Address,
        *,
        now: float,
        folder: Path | None = None,
    ) -> None:
        self.body, self.firmware, self.address = body, firmware, address
        self.vehicle_type = VehicleType.COPTER
        self.now = self.booted_at = now
        self.boots = 0
        self.faults = Faults(self)
        self.cut_off = False
        #: Callbacks that get the vehicle, a kind ("text", "mode", "armed", "mission" or "beeper") and a
        #: description.
        self.listeners: list[Callable[[SimulatedFlightController, str, str], None]] = []
        self.ports: list[MspPort] = []
        self._folder = folder
        self._eeprom = self._read_eeprom()
        self._silent_until = now
        self._reboot_due: float | None = None
        self._boot()

    def _boot(self) -> None:
        self.boots += 1
        self.booted_at = self.now
        self.system = start_firmware(self.firmware, self, self._eeprom)
        self._cli = CliCommands(self.system)
        self.system.step(self.now)

    @property
    def info(self) -> FirmwareInfo:
        """The identity that the controller reports."""
        return self.system.info

    @property
    def equipment(self) -> list[str]:
        """Names of payloads; a flight controller has none."""
        return []

    @property
    def armed(self) -> bool:
        """True while the motors are armed."""
        return self.system.arming.armed

    @property
    def arming_disable_reasons(self) -> tuple[str, ...]:
        """The names of the reasons that forbid arming now."""
        return self.system.arming.reasons

    @property
    def mode(self) -> str:
        """The name of the flight mode."""
        return self.system.mode

    @property
    def has_fix(self) -> bool:
        """True if the GPS receiver has a 3D fix."""
        return self.body.sensors.gps_fix >= FIX_3D

    # --- ports

    def open_port(self, name: str, **_: object) -> MspPort:
        """Open a port for a peer, named for logs; the options of MAVLink ports do nothing."""
        port = MspPort(name, self, honours_no_reply=self.system.info.is_inav)
        self.ports.append(port)
        return port

    def close_port(self, port: MspPort) -> None:
        """Close the port of a peer, and drop its pending data."""
        self.ports.remove(port)
        self.system.port_closed(port)

    def receive(self, port: MspPort, data: bytes) -> None:
        """Process data from a peer."""
        if not self.cut_off and self.now >= self._silent_until and self._reboot_due is None:
            port.receive(data, self.now)

    def data_to_send(self) -> list[tuple[MspPort, bytes]]:
        """Return the data sent since the last call."""
        sent = [(port, data) for port in self.ports if (data := port.take_output())]
        return [] if self.cut_off else sent

    # --- interface for the ports

    @property
    def cli_commands(self) -> Mapping[str, Callable[[str], str]]:
        """The commands of the command line interface."""
        return self._cli.commands

    def cli_entered(self) -> None:
        """Note that a peer has entered the command line interface."""
        self.system.in_cli = True

    def answer(self, frame: Frame, port: MspPort) -> bytes | None:
        """Return the payload of the reply to a request; None refuses it."""
        return self.system.answer(frame.command, frame.payload, port)

    # --- periodic update and restart

    def step(self, now: float) -> None:
        """Advance to the simulated Unix time `now`."""
        self.now = now
        if self._reboot_due is not None and now >= self._reboot_due:
            self._restart()
        if now < self._silent_until:
            return
        self.system.step(now)
        for port in self.ports:
            port.step(now)

    def request_reboot(self) -> None:
        """Restart at the next step, after the present reply."""
        self._reboot_due = self.now

    def reboot(self) -> None:
        """Restart the controller: motors off, a short silence, and the settings of the EEPROM."""
        self.request_reboot()

    def power_cycle(self) -> None:
        """Take away the power for a moment, which for a flight controller is a restart."""
        self.request_reboot()

    def _restart(self) -> None:
        self._reboot_due = None
        self.body.stop()
        for port in self.ports:
            port.restart()
        self._boot()
        self._silent_until = self.now + REBOOT_SILENCE
        self.announce("text", "reboot")

    def cut(self, off: bool) -> None:
        """Cut or restore all links."""
        self.cut_off = off

    def switch_transmitter(self, on: bool) -> bool:
        """Switch the pilot's transmitter on or off; returns whether it is off."""
        self.system.receiver.is_on = on
        return not on

    def close(self) -> None:
        """End the simulation of the controller; nothing is left to write."""

    # --- EEPROM

    def write_eeprom(self, content: bytes) -> None:
        """Keep the settings over a reboot, and in the file if there is a folder."""
        self._eeprom = content
        if self._folder is not None:
            self._folder.mkdir(parents=True, exist_ok=True)
            write_file_atomically(self._folder / EEPROM_FILE, content)

    def _read_eeprom(self) -> bytes:
        if self._folder is None:
            return b""
        try:
            return (self._folder / EEPROM_FILE).read_bytes()
        except FileNotFoundError:
            return b""

    # --- events

    def add_listener(self, listener: Callable[[SimulatedFlightController, str, str], None]) -> None:
        """Call `listener(vehicle, kind, text)` on each event; adding it again has no effect."""
        if listener not in self.listeners:
            self.listeners.append(listener)

    def announce(self, kind: str, text: str) -> None:
        """Tell the listeners of an event."""
        _LOG.debug("vehicle %d: %s", self.address.system, text)
        for listener in self.listeners:
            listener(self, kind, text)

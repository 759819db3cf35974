"""The running firmware of a flight controller: what Betaflight and iNav have in common.

In each step the receiver, the failsafe, the boxes and the arming switch are evaluated in this order, and
then the body is flown. Requests are answered by a registry of handlers by command: messages of telemetry,
messages of settings, which are read and written alike, and actions. A handler that raises `RefusedError`,
and an unknown command, are answered by an error frame.
"""

from __future__ import annotations

import struct
from abc import ABC, abstractmethod
from math import degrees, hypot
from typing import TYPE_CHECKING, ClassVar, Final

from mavstack.errors import InvalidArgumentError, MspDecodeError
from mavstack.msp.messages.rc import RxMap
from mavstack.sim.motion.readings import FIX_3D
from mavstack.sim.msp.arming import Arming
from mavstack.sim.msp.failsafe import Failsafe
from mavstack.sim.msp.receiver import Receiver, letters_of
from mavstack.sim.msp.settings import SettingFacts, SettingStore

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable, Mapping

    from mavstack.msp.firmware_info import FirmwareInfo
    from mavstack.msp.messages.base import MspMessage
    from mavstack.sim.msp.boxes import BoxTable
    from mavstack.sim.msp.cli_settings import SettingTable
    from mavstack.sim.msp.controller import SimulatedFlightController
    from mavstack.sim.msp.port import MspPort
    from mavstack.sim.msp.waypoints import Mission

#: Duration of the calibration of each sensor, in seconds.
CALIBRATION_TIMES: Final = {"gyro": 1.0, "accelerometer": 1.0, "compass": 30.0}
#: Pulse width of a stopped motor, in microseconds.
STOPPED: Final = 1000
_MOTORS: Final = 4


class RefusedError(Exception):
    """A request is answered by an error frame."""


class System(ABC):
    """The running firmware of one controller, new at each boot.

    Args:
        host: The controller.
        eeprom: The content of its EEPROM; empty for the defaults.
    """

    #: True if the firmware is iNav.
    is_inav: ClassVar[bool]
    #: The bit numbers of the reasons that forbid arming.
    reasons: ClassVar[Mapping[str, int]]
    #: The boxes (flight modes on switches) of the firmware.
    boxes: ClassVar[BoxTable]

    def __init__(self, host: SimulatedFlightController, eeprom: bytes) -> None:
        self.host, self.body = host, host.body
        self.now = self.booted_at = host.now
        self.receiver = Receiver()
        self.settings = SettingStore(self.facts())
        self.mission = self._load(eeprom)
        self.arming = Arming(self.reasons, self._armed)
        self.failsafe = Failsafe(1.0, 1.0)
        self.switched_on: frozenset[str] = frozenset()
        self.home: tuple[float, float] | None = None
        self.motor_test = [STOPPED] * _MOTORS
        self.in_cli = False
        #: Ports whose peer has disabled arming by MSP_SET_ARMING_DISABLED.
        self.arming_disabled_by: set[MspPort] = set()
        self._calibrations = {"gyro": self.now + CALIBRATION_TIMES["gyro"]}
        self._ground = self.body.estimate.down
        self._announced = ("", False)
        self.mode = self.mode_name()
        self.handlers = self.make_handlers()

    # --- implemented by each firmware

    @classmethod
    @abstractmethod
    def facts(cls) -> SettingFacts:
        """Return the settings and their defaults."""

    @property
    @abstractmethod
    def cli_settings(self) -> SettingTable:
        """The settings by their CLI names."""

    @abstractmethod
    def make_handlers(self) -> Mapping[int, Callable[[bytes, MspPort], bytes]]:
        """Return the handlers of requests by command."""

    @abstractmethod
    def arming_reasons(self) -> Iterable[str]:
        """Return what forbids arming now, without the switch."""

    @abstractmethod
    def fly(self) -> None:
        """Fly one step of the armed vehicle."""

    @abstractmethod
    def active_boxes(self) -> Collection[str]:
        """Return the boxes whose bits are set in the status."""

    @abstractmethod
    def mode_name(self) -> str:
        """Return the name of the flight mode."""

    @abstractmethod
    def _load(self, eeprom: bytes) -> Mission:
        """Read the settings, and return the mission."""

    @abstractmethod
    def configure(self) -> None:
        """Apply settings to the receiver and the failsafe."""

    # --- state

    @property
    def info(self) -> FirmwareInfo:
        """The identity that the controller reports."""
        return self.settings.facts.info

    @property
    def altitude(self) -> float:
        """Estimated altitude in metres above the place where the controller was armed."""
        return self._ground - self.body.estimate.down

    @property
    def has_fix(self) -> bool:
        """True if the GPS receiver has a 3D fix."""
        return self.body.sensors.gps_fix >= FIX_3D

    @property
    def calibrating(self) -> Collection[str]:
        """The sensors that are being calibrated."""
        return [name for name, end in self._calibrations.items() if self.now < end]

    @property
    def tilt(self) -> float:
        """The angle between the body and the horizon in degrees."""
        estimate = self.body.estimate
        return degrees(hypot(estimate.roll, estimate.pitch))

    def calibrate(self, sensor: str) -> None:
        """Start a calibration, unless the vehicle is armed."""
        if not self.arming.armed:
            self._calibrations[sensor] = self.now + CALIBRATION_TIMES[sensor]
            self.host.announce("text", f"{sensor} calibration started")

    def number(self, name: str) -> int:
        """Return the value of a setting by its CLI name, an integer of the firmware."""
        setting = self.cli_settings.get(name)
        if setting is None:
            raise LookupError(name)
        return int(setting.value(self.settings))

    @property
    def default_channel_map(self) -> str:
        """The letters of the default channel map."""
        return letters_of(self.settings.default(RxMap).positions)

    def set_channel_map(self, positions: tuple[int, ...]) -> None:
        """Change the channel map, to as many channels as the firmware maps."""
        count = len(self.settings.default(RxMap).positions)
        self.settings.put(RxMap(positions[:count]))
        self.configure()

    # --- periodic update

    def step(self, now: float) -> None:
        """Advance to a time."""
        self.now = now
        armed = self.arming.armed
        self.receiver.step(now)
        has_signal = self.receiver.has_signal(now)
        self.failsafe.step(
            now, has_signal=has_signal, switched_on="FAILSAFE" in self.switched_on, armed=armed
        )
        self.switched_on = self.boxes.switched_on(self.settings.mode_ranges, self.receiver.channels)
        self._end_calibrations(now)
        reasons = () if self.arming.armed else self.arming_reasons()
        self.arming.step(reasons, "ARM" in self.switched_on)
        if self.arming.armed:
            self.fly()
        self._announce_changes()

    def _end_calibrations(self, now: float) -> None:
        for sensor, end in tuple(self._calibrations.items()):
            if now >= end:
                del self._calibrations[sensor]
                if sensor != "gyro":
                    self.host.announce("text", f"{sensor} calibration complete")

    def _announce_changes(self) -> None:
        self.mode, beeps = self.mode_name(), "BEEPER" in self.switched_on
        mode, was_beeping = self._announced
        if self.mode != mode:
            self.host.announce("mode", f"mode {self.mode}")
        if beeps is not was_beeping:
            self.host.announce("beeper", f"beeper {'on' if beeps else 'off'}")
        self._announced = (self.mode, beeps)

    def _armed(self, armed: bool, reason: str) -> None:
        if armed:
            here = self.body.estimate
            self._ground = here.down
            if self.has_fix:
                self.home = here.north, here.east
            self.motor_test = [STOPPED] * _MOTORS
        else:
            self.body.stop()
        self.host.announce("armed", f"{'armed' if armed else 'disarmed'} by {reason}")

    # --- requests

    def answer(self, command: int, payload: bytes, port: MspPort) -> bytes | None:
        """Return the payload of the reply to a request; None refuses it."""
        handler = self.handlers.get(command)
        if handler is None:
            return None
        try:
            return handler(payload, port)
        except (RefusedError, MspDecodeError, InvalidArgumentError, struct.error):
            return None

    def port_closed(self, port: MspPort) -> None:
        """Note that a peer has left."""
        self.arming_disabled_by.discard(port)

    def save(self) -> None:
        """Write the settings to the EEPROM; raises RefusedError while the vehicle is armed."""
        if self.arming.armed:
            raise RefusedError
        self.host.write_eeprom(self.settings.encode(self.mission.saved))
        self.host.announce("text", "settings saved")

    def encode(self, message: MspMessage) -> bytes:
        """Return the payload of a message."""
        return message.encode(self.info)

    # --- handlers of requests that both firmwares support

    def producer(self, produce: Callable[[System], MspMessage]) -> Callable[[bytes, MspPort], bytes]:
        """Return a handler that sends the message that a function makes."""
        return lambda payload, port: self.encode(produce(self))

    def reader(self, kind: type[MspMessage]) -> Callable[[bytes, MspPort], bytes]:
        """Return a handler that sends a message of the settings."""
        return lambda payload, port: self.encode(self.settings.get(kind))

    def writer(self, kind: type[MspMessage], written: type[MspMessage]) -> Callable[[bytes, MspPort], bytes]:
        """Return a handler that changes a message of the settings by one that writes it."""

        def write(payload: bytes, port: MspPort) -> bytes:
            self.settings.update(kind, written.decode(payload, self.info))
            self.configure()
            return b""

        return write

    def action(self, act: Callable[[bytes, MspPort], None]) -> Callable[[bytes, MspPort], bytes]:
        """Return a handler that acts, and sends an empty reply."""

        def run(payload: bytes, port: MspPort) -> bytes:
            act(payload, port)
            return b""

        return run

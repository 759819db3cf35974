"""One simulated vehicle as a MAVLink component: the services of the floor below, and the autopilot behind.

It needs no event loop and no clock: bytes go in by `receive`, time by `step`, and what it sends comes out of
`data_to_send`. What clients ask of the services comes as their events to whoever said `on` for them; what the
autopilot does goes back to the services.

    vehicle = simulation.add(VehicleType.COPTER, Firmware.ARDUPILOT)
    port = vehicle.open_port("ground")
    vehicle.receive(port, data)
    for port, data in vehicle.data_to_send(): ...

A reboot makes the services and the autopilot anew; ports, parameters, plans, files and the body stay.
"""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING, Any, TypeVar

from mavstack.dialects import Dialect, common
from mavstack.services.mission import PlanStore
from mavstack.sim.autopilot.autopilot import SimulatedAutopilot
from mavstack.sim.autopilot.state import TICK
from mavstack.sim.faults import Faults
from mavstack.sim.port import Port
from mavstack.sim.recorder import Recorder
from mavstack.sim.services import Services
from mavstack.sim.storage import Storage

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from mavstack.services import Address, Event, Service
    from mavstack.sim.autopilot.interfaces import FirmwareProfile, Mode
    from mavstack.sim.motion import Body
    from mavstack.sim.parameters import Parameters
    from mavstack.sim.vehicle_types import Firmware, VehicleType
    from mavstack.wire import Packet, Signing

AnyEvent = TypeVar("AnyEvent", bound="Event")

#: How long nothing is heard of a vehicle that reboots, in seconds.
REBOOT_SILENCE = 1.0
LARGEST_ID = 255


class SimulatedVehicle:
    """A vehicle that other programs can talk to."""

    def __init__(
        self,
        body: Body,
        type: VehicleType,  # noqa: A002 (HEARTBEAT's name for it)
        firmware: Firmware,
        address: Address,
        profile: FirmwareProfile,
        parameters: Parameters,
        now: float,
        *,
        folder: Path | None = None,
    ) -> None:
        self.body, self.type, self.firmware, self.address = body, type, firmware, address
        self.profile = profile
        self.parameters = parameters
        self.plans = PlanStore()
        self.now = self.booted_at = now
        self.boots = 0
        #: Told of what the vehicle says and does: itself, "text", "mode" or "armed", and words for people.
        self.listeners: list[Callable[[SimulatedVehicle, str, str], None]] = []
        self.ports: list[Port] = []
        self.storage = Storage(self, folder=folder)
        self.recorder = Recorder(self)
        self.faults = Faults(self)
        #: Whether nothing gets through, in either direction.
        self.cut_off = False
        #: What was sent before it fell silent.
        self._last_words: list[tuple[Port, bytes]] = []
        self._dialect = Dialect.load("all")
        self._silent_until = now
        self._boot()

    def _boot(self) -> None:
        self.boots += 1
        self.booted_at = self.now
        self._reactions: dict[type, list[Callable[[Any], None]]] = defaultdict(list)
        self._to_send: list[tuple[Port, bytes]] = []
        self._tick_due = self.now + self.address.system % 5 * TICK / 5  # the fleet's load is spread
        self.services = Services(self, self._dialect)
        self.engine = self.services.engine
        self.modes, self.commands = self.services.modes, self.services.commands
        self.messages, self.mission = self.services.messages, self.services.mission
        self.autopilot = SimulatedAutopilot(self, self.profile)
        self.profile.register(self)
        self.profile.provide(self)
        self.profile.booted(self)
        for port in self.ports:
            self._connect(port)

    # Ports

    def open_port(
        self,
        name: str,
        *,
        signing: Signing | None = None,
        bandwidth: float | None = None,
        bulk_rate: float | None = None,
    ) -> Port:
        """A peer appeared; `bandwidth` in bytes and `bulk_rate` in packets a second, where they are known."""
        port = Port(name, {"signing": signing, "bandwidth": bandwidth, "bulk_rate": bulk_rate})
        self.ports.append(port)
        self._connect(port)
        self.services.beacon.send_now(self.now)
        self.touch(self.services.beacon)
        return port

    def close_port(self, port: Port) -> None:
        """The peer is gone."""
        self.ports.remove(port)
        if port.state is not None:
            self.engine.close_channel(port.state)
        self._to_send = [item for item in self._to_send if item[0] is not port]
        self._last_words = [item for item in self._last_words if item[0] is not port]

    def _connect(self, port: Port) -> None:
        port.state = self.engine.open_channel(port.name, **port.options)

    def receive(self, port: Port, data: bytes) -> list[Packet]:
        """Take in what a peer sent; answers are made at once."""
        if port.state is None or self.cut_off or self.now < self._silent_until:
            return []
        packets = self.engine.receive(port.state, data, self.now)
        self._settle()
        return packets

    def data_to_send(self) -> list[tuple[Port, bytes]]:
        """What was sent since the last call, in order."""
        sent, self._last_words = self._last_words, []
        if self.now < self._silent_until:
            return sent
        self._settle()
        if not self.cut_off:
            sent += self._to_send
        self._to_send = []
        return sent

    # Time

    def step(self, now: float) -> None:
        """Go on in time."""
        self.now = now
        if now < self._silent_until:
            return
        if now >= self._tick_due:
            self._tick_due += TICK
            self.autopilot.tick(now)
            self.refresh_heartbeat()
            self.recorder.tick(now)
        due = self.engine.next_timeout()
        if due is not None and due <= now:
            self.engine.handle_timeout(now)
        self._settle()

    @property
    def uptime(self) -> float:
        """Seconds since power, or since the last reboot."""
        return self.now - self.booted_at

    @property
    def uptime_ms(self) -> int:
        """The same as `time_boot_ms` has it."""
        return int(self.uptime * 1000) & 0xFFFFFFFF

    def reboot(self) -> None:
        """Restart the autopilot: motors off wherever it is, then silence, perhaps another system id."""
        self.fall_silent()
        self.body.stop()
        if 0 < self.parameters.system <= LARGEST_ID:  # two vehicles may have the same, as real ones may
            self.address = self.address._replace(system=self.parameters.system)
        self._boot()
        self._silent_until = self.now + REBOOT_SILENCE

    def close(self) -> None:
        """Finish the log that is being written: the vehicle goes away."""
        self.storage.logs.end()

    def cut(self, off: bool) -> None:
        """Cut all links, or make them whole again; what was sent before still arrives."""
        if off and not self.cut_off:
            self.fall_silent()
        self.cut_off = off

    def fall_silent(self) -> None:
        """Have what was to be said until now go out, such as the acknowledgement of a reboot."""
        self._settle()
        if not self.cut_off:
            self._last_words += self._to_send
        self._to_send = []

    # For the parts of the vehicle

    def add_listener(self, listener: Callable[[SimulatedVehicle, str, str], None]) -> None:
        """Call `listener(vehicle, kind, text)` on each event; adding it again has no effect."""
        if listener not in self.listeners:
            self.listeners.append(listener)

    def on_event(self, kind: type[AnyEvent], reaction: Callable[[AnyEvent], None]) -> None:
        """Call `reaction` with each event of a class out of the services."""
        self._reactions[kind].append(reaction)

    def touch(self, service: Service) -> None:
        """Say that a service's method was called, so that what it wants to send goes out."""
        self.engine.touch(service)

    def send_statustext(self, text: str, severity: int = common.MavSeverity.INFO) -> None:
        """Say something by STATUSTEXT, and write it into the log."""
        self.services.texts.say(text, severity)
        self.touch(self.services.texts)
        self.recorder.text(text, severity)
        self._tell("text", text)

    def mode_entered(self, mode: Mode, reason: str) -> None:
        """The autopilot is in another mode: tell it."""
        self.recorder.mode(mode.number, reason)
        self._tell("mode", f"mode {mode.name}")
        self.refresh_heartbeat()

    def armed_changed(self) -> None:
        """The autopilot was armed or disarmed: tell it, and begin or end a log."""
        self.recorder.armed(self.autopilot.armed)
        self._tell("armed", "armed" if self.autopilot.armed else "disarmed")
        self.refresh_heartbeat()

    def home_changed(self) -> None:
        """There is another home: tell it."""
        self.recorder.home(self.autopilot.home)
        self.profile.home_changed(self)

    def refresh_heartbeat(self) -> None:
        """Say at once what HEARTBEAT tells."""
        self.services.refresh_heartbeat()

    def _tell(self, kind: str, text: str) -> None:
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

"""A simulated board, sans-IO: a bootloader that starts a simulated autopilot, on one serial port.

The autopilot starts its bootloader by PREFLIGHT_REBOOT_SHUTDOWN, and the bootloader starts the autopilot by
REBOOT, or after some seconds without a host if there is a firmware. Parameters outlast both.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.flashing.bootloader_client import Op
from mavstack.flashing.simulated_bootloader import SimulatedBootloader
from mavstack.sim import Simulation
from mavstack.sim.vehicle_types import VehicleType

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.flashing.board import Board
    from mavstack.sim.vehicle import SimulatedVehicle

#: Seconds without a request after which a bootloader starts its firmware.
HOST_TIMEOUT: Final = 5.0
#: Seconds between two simulation steps of the autopilot.
_STEP: Final = 0.02
_PORT: Final = "usb"
#: Bootloader requests that the listeners are informed of, with the text.
_EVENTS: Final = {Op.CHIP_ERASE: "flash erased", Op.EXTF_ERASE: "external flash erased"}


class SimulatedBoard:
    """A board with a bootloader and an autopilot.

    Args:
        firmware: The firmware of the autopilot, "px4" or "ardupilot".
        board: The board.
        has_firmware: Begin with the autopilot; False: in the bootloader, with an empty flash.
        forgets: A new firmware resets the parameters, as a change of their layout does.
    """

    def __init__(
        self, firmware: str, board: Board, *, has_firmware: bool = False, forgets: bool = False
    ) -> None:
        self.bootloader = SimulatedBootloader(board)
        self.bootloader.listeners.append(self._carried_out)
        #: Called with a text for each event.
        self.listeners: list[Callable[[str], None]] = []
        self._simulation = Simulation()
        self.vehicle: SimulatedVehicle = self._simulation.add(VehicleType.COPTER, firmware)
        self.vehicle.board_id = board.board_id
        self.vehicle.reboot()  # reboot: the vehicle reads its board id when it boots
        self.vehicle.add_listener(self._vehicle_event)
        self._port = self.vehicle.open_port(_PORT)
        self._forgets = forgets
        self._erased = False
        self._output = bytearray()
        #: Time of the autopilot's last simulation step, and of the host's last bytes, by the caller's clock.
        self._advanced_at: float | None = None
        self._host_at: float | None = None
        self.in_bootloader = not has_firmware
        if has_firmware:
            self.bootloader.internal.content[:4] = b"\0\0\0\x20"

    def receive(self, data: bytes, now: float) -> None:
        """Process bytes of a host."""
        self.handle_timeout(now)
        if self.in_bootloader:
            self._host_at = now
            self.bootloader.receive(data, now)
            self._after_bootloader(now)
        else:
            self.vehicle.receive(self._port, data)
            self._take_output()

    def output(self) -> bytes:
        """Return the bytes for the host, once."""
        data = bytes(self._output)
        self._output.clear()
        return data

    def next_timeout(self) -> float | None:
        """Return the time of the next `handle_timeout`, or None."""
        if not self.in_bootloader:
            return None if self._advanced_at is None else self._advanced_at + _STEP
        times = [self.bootloader.next_timeout()]
        if self.bootloader.has_firmware and self._host_at is not None:
            times.append(self._host_at + HOST_TIMEOUT)
        return min((time for time in times if time is not None), default=None)

    def handle_timeout(self, now: float) -> None:
        """Advance to the time `now`."""
        if self._host_at is None:
            self._host_at = now
        if self.in_bootloader:
            self.bootloader.handle_timeout(now)
            self._after_bootloader(now)
            if self.bootloader.has_firmware and now >= self._host_at + HOST_TIMEOUT:
                self._start(now)
        else:
            passed = 0.0 if self._advanced_at is None else now - self._advanced_at
            self._advanced_at = now
            if passed > 0:
                self._simulation.advance(self._simulation.now + passed)
            self._take_output()

    def power_cycle(self, now: float) -> None:
        """Lose the power for a moment."""
        self.bootloader.power_cycle()
        self.vehicle.power_cycle()
        self._enter_bootloader(now)

    def _after_bootloader(self, now: float) -> None:
        self._output += self.bootloader.output()
        if self.bootloader.started:
            self._start(now)

    def _start(self, now: float) -> None:
        """Start the autopilot."""
        if self._erased and self._forgets:
            self.vehicle.parameters.reset()
        self._erased = False
        self.vehicle.reboot()
        self.in_bootloader, self._advanced_at = False, now
        self._announce("firmware started")

    def _enter_bootloader(self, now: float | None) -> None:
        self.bootloader.power_cycle()
        self.in_bootloader, self._advanced_at, self._host_at = True, None, now

    def _vehicle_event(self, _: SimulatedVehicle, kind: str, __: str) -> None:
        if kind == "bootloader":
            self._take_output()
            self._enter_bootloader(None)
            self._announce("waits in its bootloader")

    def _carried_out(self, op: Op) -> None:
        self._erased = self._erased or op is Op.CHIP_ERASE
        if op in _EVENTS:
            self._announce(_EVENTS[op])

    def _take_output(self) -> None:
        for _, data in self.vehicle.data_to_send():
            self._output += data

    def _announce(self, text: str) -> None:
        for listener in self.listeners:
            listener(text)

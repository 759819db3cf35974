"""The commands of a bridge beside modes: arming, calibrations, restart, saving settings, beeper."""

from __future__ import annotations

import asyncio
import logging
from math import isfinite
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.errors import InvalidStateError, LinkError, MspError, RemoteCancelled
from mavstack.msp.messages.actions import Reboot, RebootMode
from mavstack.msp.messages.arming import SensorFlag
from mavstack.msp.messages.sensors import AccCalibration, MagCalibration
from mavstack.services import Address

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable

    from mavstack.bridges.msp.flight_controller import FlightController
    from mavstack.bridges.msp.pilot import Pilot
    from mavstack.bridges.msp.status import ControllerStatus
    from mavstack.node import Node
    from mavstack.services.command import CommandRequest
    from mavstack.wire import Packet

_CMD: Final = common.MavCmd
_RESULT: Final = common.MavResult
_FAILURES = (MspError, LinkError, RemoteCancelled, InvalidStateError)
#: The numbers of the params of PREFLIGHT_CALIBRATION for the compass and the accelerometer.
_COMPASS, _ACCELEROMETER = 2, 5
#: Seconds in which the firmware must report that a calibration has begun.
BEGIN_TIMEOUT: Final = 0.6
#: Maximum seconds that the calibration of the accelerometer takes.
ACCELEROMETER_TIMEOUT: Final = 15.0
#: Seconds for which the firmwares collect the magnetic field.
COMPASS_TIME: Final = 30.0
_CHECK_INTERVAL: Final = 0.05
_REBOOT, _BOOTLOADER = 1, 3
_WRITE = 1

logger = logging.getLogger("mavstack.bridges.msp")


class BridgedCommands:
    """The commands of one bridge.

    Args:
        node: The node of the bridge.
        controller: The flight controller.
        pilot: Arms, disarms and beeps by RC channels.
        status: Returns the latest status of the flight controller.
        save: Saves settings and missions.
        restarting: Called when the flight controller was told to restart.
        report: Sends a status text with a MAV_SEVERITY.
    """

    def __init__(
        self,
        node: Node,
        controller: FlightController,
        pilot: Pilot,
        *,
        status: Callable[[], ControllerStatus],
        save: Callable[[], Awaitable[None]],
        restarting: Callable[[], None],
        report: Callable[[str, int], None],
    ) -> None:
        self._node, self._controller, self._pilot = node, controller, pilot
        self._status, self._save, self._restarting, self._report = status, save, restarting, report
        self._tasks: set[asyncio.Task[None]] = set()
        node.on_command(_CMD.COMPONENT_ARM_DISARM)(self._arm_or_disarm)
        node.on_command(_CMD.DO_FLIGHTTERMINATION)(self._terminate)
        node.on_command(_CMD.PREFLIGHT_CALIBRATION)(self._calibrate)
        node.on_command(_CMD.PREFLIGHT_REBOOT_SHUTDOWN)(self._reboot)
        node.on_command(_CMD.PREFLIGHT_STORAGE)(self._store)
        node.add_packet_listener((common.PlayTune, common.PlayTuneV2), self._play_tune)

    async def _arm_or_disarm(self, request: CommandRequest) -> common.MavResult:
        if request.command.param1 == 1:
            return await self._pilot.arm(request.source)
        return await self._pilot.disarm(request.source)

    async def _terminate(self, request: CommandRequest) -> common.MavResult:
        if request.command.param1 != 1:
            return _RESULT.DENIED
        return await self._pilot.disarm(request.source)

    async def _reboot(self, request: CommandRequest) -> common.MavResult:
        modes = {_REBOOT: RebootMode.FIRMWARE, _BOOTLOADER: RebootMode.BOOTLOADER_ROM}
        mode = modes.get(_integer(request.command.param1))
        if mode is None or (mode is not RebootMode.FIRMWARE and self._controller.info.is_inav):
            return _RESULT.UNSUPPORTED
        if self._status().armed:
            return self._deny("Reboot refused: armed")
        try:
            await self._controller.send(Reboot(None if mode is RebootMode.FIRMWARE else mode))
        except RemoteCancelled:  # the controller rebooted before it replied
            pass
        except _FAILURES as error:
            return self._fail(error)
        asyncio.get_running_loop().call_soon(self._restarting)  # runs after the acknowledgement is sent
        return _RESULT.ACCEPTED

    async def _store(self, request: CommandRequest) -> common.MavResult:
        if _integer(request.command.param1) != _WRITE:
            return _RESULT.UNSUPPORTED
        if self._status().armed:
            return self._deny("Saving refused: armed")
        try:
            await self._save()
        except _FAILURES as error:
            return self._fail(error)
        return _RESULT.ACCEPTED

    async def _calibrate(self, request: CommandRequest) -> common.MavResult:
        params = [getattr(request.command, f"param{number}") for number in range(1, 8)]
        wanted = [(number, value) for number, value in enumerate(params, 1) if value and isfinite(value)]
        if wanted not in ([(_COMPASS, 1)], [(_ACCELEROMETER, 1)]):
            return _RESULT.UNSUPPORTED
        if self._status().armed:
            return self._deny("Calibration refused: armed")
        is_compass = wanted[0][0] == _COMPASS
        if is_compass and not self._status().sensors & SensorFlag.MAGNETOMETER:
            return self._deny("Calibration refused: there is no compass")
        try:
            await self._controller.send(MagCalibration() if is_compass else AccCalibration())
        except _FAILURES as error:
            return self._fail(error)
        return await self._wait_for_calibration(request, is_compass=is_compass)

    async def _wait_for_calibration(self, request: CommandRequest, *, is_compass: bool) -> common.MavResult:
        """Wait until the firmware has calibrated; it reports that by a reason not to arm, or not at all."""
        loop = asyncio.get_running_loop()
        started = loop.time()
        seen, limit = False, COMPASS_TIME if is_compass else ACCELEROMETER_TIMEOUT
        reported = -1
        while (elapsed := loop.time() - started) < limit:
            calibrating = self._status().calibrating
            if seen and not calibrating:
                return _RESULT.ACCEPTED
            seen = seen or calibrating
            if not seen and elapsed > BEGIN_TIMEOUT and not is_compass:
                return _RESULT.ACCEPTED
            percent = int(100 * elapsed / limit) if is_compass else 0
            if percent // 10 > reported:
                reported = percent // 10
                self._node.commands.progress(request, percent)
            await asyncio.sleep(_CHECK_INTERVAL)
        return _RESULT.FAILED if seen and not is_compass else _RESULT.ACCEPTED

    def _play_tune(self, packet: Packet) -> None:
        if packet.message.target_system not in (0, self._node.address.system):
            return
        task = asyncio.get_running_loop().create_task(self._beep(Address(packet.system, packet.component)))
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    async def _beep(self, source: Address) -> None:
        reason = await self._pilot.beep(source)
        if reason is not None:
            self._report(f"Beeper refused: {reason}", common.MavSeverity.WARNING)

    def _deny(self, text: str) -> common.MavResult:
        self._report(text, common.MavSeverity.WARNING)
        return _RESULT.DENIED

    def _fail(self, error: Exception) -> common.MavResult:
        self._report(str(error), common.MavSeverity.ERROR)
        return _RESULT.FAILED


def _integer(value: float) -> int:
    return int(value) if isfinite(value) else -1

"""PX4's calibrations, and the person who handles the simulated vehicle meanwhile.

A calibration is accepted when it starts; status texts report it, and ground stations parse them. For the
accelerometer and the compass the person turns the vehicle onto one pending side after the other; for the
airspeed the person blows into the pitot tube, for the ESCs connects the battery. A PREFLIGHT_CALIBRATION with
all params 0 cancels a calibration, and ends the one of the radio control.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.sim.autopilot.commands import CommandGroup, Handlers, Outcome, waiting
from mavstack.sim.vehicle_types import VehicleType

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.services.command import Command, CommandRequest
    from mavstack.sim.autopilot.tasks import Script
    from mavstack.sim.px4.state import Px4State
    from mavstack.sim.vehicle import SimulatedVehicle

    Steps = Iterator[None]

_RESULT: Final = common.MavResult
#: The names that PX4 uses for the sides of the vehicle, in the order in which its status texts list them.
SIDES: Final = ("back", "front", "left", "right", "up", "down")
_WINGED: Final = (VehicleType.PLANE, VehicleType.VTOL)
#: Seconds per 10 % of a calibration that does not need different orientations of the vehicle.
_STEP_TIME: Final = 0.2
#: Seconds in which the user turns the vehicle to the next side, and in which one side is measured.
_TURN_TIME, _MEASURING_TIME = 1.0, 0.8
#: Seconds of rotation for each side that PX4 announces in its status text.
_ROTATION_TIME: Final = 7
#: Seconds until the user blows into the pitot tube or connects the battery, and until the ESCs are
#: calibrated.
_HAND_TIME, _ESC_TIME = 2.0, 3.0
#: Seconds after the end of a calibration in which a new calibration is refused.
_CLEANUP_TIME: Final = 0.8


def requested_calibration(command: Command) -> str:
    """Return the name of the first calibration that a PREFLIGHT_CALIBRATION requests; "" if none."""
    first = {
        "gyro": command.param1 == 1,
        "mag": command.param2 == 1,
        "baro": command.param3 == 1,
        "radio": command.param4 == 1,
        "accel": command.param5 == 1,
        "level": command.param5 == 2,
        "quick accel": command.param5 == 4,
        "airspeed": command.param6 in (1, 2),
        "esc": command.param7 == 1,
    }
    return next((name for name, requested in first.items() if requested), "")


class Px4CalibrationCommands(CommandGroup):
    """PREFLIGHT_CALIBRATION."""

    def __init__(self, vehicle: SimulatedVehicle, state: Px4State) -> None:
        super().__init__(vehicle)
        self._state = state

    def handlers(self) -> Handlers:
        return {common.MavCmd.PREFLIGHT_CALIBRATION: self.calibrate}

    def calibrate(self, request: CommandRequest) -> Outcome:
        """Answer PREFLIGHT_CALIBRATION: one sensor at a time."""
        command, state = request.command, self._state
        if self.autopilot.armed:
            return _RESULT.TEMPORARILY_REJECTED
        name = requested_calibration(command)
        if not name:
            return self._end() if command.param4 == 0 else _RESULT.UNSUPPORTED
        if state.calibrating:
            return _RESULT.TEMPORARILY_REJECTED
        if name == "airspeed" and self.vehicle.vehicle_type not in _WINGED:
            self._send("calibration failed: no airspeed sensor")
            return _RESULT.DENIED
        state.calibrating, state.calibration_cancelled = name, False
        if name == "radio":
            self.vehicle.send_statustext("Calibration: Disabling RC input")
        else:
            self.autopilot.tasks.run(self._calibrating(name))
        return _RESULT.ACCEPTED

    def _end(self) -> common.MavResult:
        """Cancel the running calibration, or end the one of the radio control."""
        state = self._state
        if state.calibrating == "radio":
            state.calibrating = ""
            self.vehicle.send_statustext("Calibration: Restoring RC input")
        elif state.calibrating:
            state.calibration_cancelled = True
        return _RESULT.ACCEPTED

    def _calibrating(self, name: str) -> Script:
        """Calibrate a sensor to its end, or until it is cancelled."""
        sensor = name.removeprefix("quick ")
        self._send(f"calibration started: 2 {sensor}")
        for _ in self._script(name):
            if self._state.calibration_cancelled:
                self._send("calibration cancelled", common.MavSeverity.CRITICAL)
                break
            yield None
        else:
            self._clear_fault(name)
            self._send(f"calibration done: {sensor}")
        yield from self._pause(_CLEANUP_TIME)
        self._state.calibrating = ""
        return _RESULT.ACCEPTED

    def _script(self, name: str) -> Steps:
        match name:
            case "accel" | "mag":
                return self._turning(rotates=name == "mag")
            case "airspeed":
                return self._blowing()
            case "esc":
                return self._powering()
            case _:
                return self._still(silent=name == "baro")

    def _still(self, *, silent: bool = False) -> Steps:
        """Measure a sensor that is at rest; a barometer reports no progress."""
        for percent in range(0, 101, 10):
            if not silent:
                self._send(f"progress <{percent}>")
            yield from self._pause(_STEP_TIME)

    def _turning(self, *, rotates: bool) -> Steps:
        """Measure all sides, which the person turns down one after the other."""
        pending = list(SIDES)
        while pending:
            self._send("pending: " + " ".join(pending))
            self._send("hold vehicle still on a pending side")
            yield from self._pause(_TURN_TIME)
            side = pending.pop(0)
            self._send("detected rest position, hold still...")
            for _ in range(2):
                self._send(f"{side} orientation detected")
            if rotates:
                yield from self._rotating(side, done=len(SIDES) - len(pending) - 1)
            else:
                self._send(f"Hold still, measuring {side} side")
                yield from self._pause(_MEASURING_TIME)
            for _ in range(2):
                self._send(f"{side} side done, rotate to a different side")
            self._send(f"progress <{min(17 * (len(SIDES) - len(pending)), 100)}>")

    def _rotating(self, side: str, *, done: int) -> Steps:
        """Measure the compass while the person rotates the vehicle with one side down."""
        self._send("Rotate vehicle around the detected orientation")
        self._send(f"Continue rotation for {side} {_ROTATION_TIME} s")
        for part in (1, 2):
            yield from self._pause(_MEASURING_TIME / 2)
            self._send(f"{side} side calibration: progress <{done * 100 // len(SIDES) + part * 8}>")

    def _blowing(self) -> Steps:
        """Measure the airspeed sensor without wind, then with pressure."""
        self._send("Ensure sensor is not measuring wind", common.MavSeverity.CRITICAL)
        yield from self._still()
        self._send("Offset of 0 Pascal")
        self._send("Blow into front of pitot without touching", common.MavSeverity.CRITICAL)
        yield from self._pause(_HAND_TIME)
        self._send("Positive pressure: OK (67 Pa)")

    def _powering(self) -> Steps:
        """Drive the ESCs at full throttle while the person connects the battery, then at none."""
        self._send("Connect battery now")
        yield from self._pause(_HAND_TIME)
        self._send("Battery connected")
        yield from self._pause(_ESC_TIME)

    def _pause(self, seconds: float) -> Steps:
        for _ in waiting(self.vehicle, seconds):
            yield None

    def _send(self, text: str, severity: int = common.MavSeverity.INFO) -> None:
        self.vehicle.send_statustext(f"[cal] {text}", common.MavSeverity(severity))

    def _clear_fault(self, name: str) -> None:
        """Clear the fault of a calibrated sensor."""
        if name == "mag":
            self.vehicle.faults.inject("compass 0")
        elif name == "baro":
            self.vehicle.faults.inject("baro 0")

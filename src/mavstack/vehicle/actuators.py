"""The outputs of a vehicle: servos, relays, actuators, motors on the ground, gripper and winch.

    await vehicle.actuators.set_servo(9, 1900)
    await vehicle.actuators.release()
    await vehicle.actuators.test_motor(1, throttle=10, duration=2)

A vehicle acknowledges an output when it is set: nothing measures whether a servo or a gripper has moved. A
winch reports its line and its speed, which the calls wait for (`actions.winch`). PX4 drives
outputs by actuator number from -1 to 1, ArduPilot by servo number and pulse; each lacks the call of the other
(`ActionUnsupported`).
"""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.errors import ActionInterrupted, InvalidArgumentError
from mavstack.node.api_object import ReadOnly
from mavstack.services.arguments import check_number, check_text
from mavstack.vehicle.action_monitor import ActionGoal, ActionMonitor
from mavstack.vehicle.actions import winch as winching
from mavstack.vehicle.actions.preconditions import check_preconditions
from mavstack.vehicle.deadline import deadline
from mavstack.vehicle.firmware import firmware_of
from mavstack.vehicle.status_text_capture import with_status_texts

if TYPE_CHECKING:
    from collections.abc import Coroutine
    from typing import Any

    from mavstack.vehicle.firmware import Firmware
    from mavstack.vehicle.vehicle import Vehicle

_CMD: Final = common.MavCmd
_GRIP: Final = common.GripperActions
_WINCH: Final = common.WinchActions
#: The longest pulse that a servo output can have, in microseconds.
MAX_PULSE: Final = 2500
#: The longest motor test in seconds; it is ArduPilot's limit.
MAX_MOTOR_TEST: Final = 600.0
#: The largest number of characters of a tune.
MAX_TUNE: Final = 248
#: The tune of `beep`: three short notes.
DEFAULT_TUNE: Final = "MFT200L16CCC"
#: A motor test that is repeated is extended this long before its end, in seconds.
_OVERLAP: Final = 1.0
#: The time after a motor test in which the heartbeat may still say that the vehicle is armed, in seconds.
_DISARMING_TIME: Final = 5.0


class Actuators(ReadOnly):
    """The outputs of a vehicle; `vehicle.actuators`."""

    def __init__(self, vehicle: Vehicle) -> None:
        self._vehicle = vehicle

    async def set_servo(self, number: int, pulse: int, *, timeout: float | None = None) -> None:
        """Set the pulse of a servo output (MAV_CMD_DO_SET_SERVO).

        ArduPilot refuses outputs that one of its own functions drives, such as motors.

        Args:
            number: The number of the output, from 1.
            pulse: The pulse in microseconds, 0 to 2500; 0 stops the pulses.
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Raises:
            InvalidTypeError: An argument is not a number.
            InvalidArgumentError: The number or the pulse is out of range.
            ActionUnsupported: The firmware has no servo numbers (PX4); nothing was sent.
            CommandDenied: The vehicle refused.
            CommandTimeout: The vehicle did not answer.
            ActionTimeout: The call did not end within `timeout`.
        """
        _check_whole("servo number", number, 1, 255)
        _check_whole("pulse", pulse, 0, MAX_PULSE)
        firmware = self._firmware("servo")
        await self._request(f"setting servo {number} of", firmware.set_servo(number, pulse), timeout)

    async def set_relay(self, number: int, on: bool, *, timeout: float | None = None) -> None:
        """Switch a relay (MAV_CMD_DO_SET_RELAY).

        Args:
            number: The number of the relay, from 0.
            on: True switches it on.
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Raises:
            InvalidTypeError: The number is not a number.
            InvalidArgumentError: The number is out of range.
            ActionUnsupported: The firmware has no relays (PX4); nothing was sent.
            CommandDenied: The vehicle refused, such as a relay that is not set up.
            CommandTimeout: The vehicle did not answer.
            ActionTimeout: The call did not end within `timeout`.
        """
        _check_whole("relay number", number, 0, 255)
        firmware = self._firmware("relay")
        await self._request(f"switching relay {number} of", firmware.set_relay(number, on=on), timeout)

    async def set_actuator(self, number: int, value: float, *, timeout: float | None = None) -> None:
        """Set an actuator output; all others keep their value (MAV_CMD_DO_SET_ACTUATOR).

        Args:
            number: The number of the actuator, from 1: PX4's output function "Peripheral via Actuator Set N".
            value: The value, -1 to 1.
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Raises:
            InvalidTypeError: An argument is not a number.
            InvalidArgumentError: The number or the value is out of range.
            ActionUnsupported: The firmware has no actuator numbers (ArduPilot); nothing was sent.
            CommandDenied: The vehicle refused.
            CommandTimeout: The vehicle did not answer.
            ActionTimeout: The call did not end within `timeout`.
        """
        _check_whole("actuator number", number, 1, 255)
        _check_range("actuator value", value, -1.0, 1.0)
        firmware = self._firmware("actuator")
        await self._request(f"setting actuator {number} of", firmware.set_actuator(number, value), timeout)

    async def test_motor(
        self,
        number: int,
        *,
        throttle: float = 5.0,
        duration: float = 2.0,
        wait: bool = True,
        timeout: float | None = None,
    ) -> None:
        """Run one motor of a disarmed vehicle for some time, then stop it. Take the propellers off.

        Cancelling the call stops the motor. Without a connection the motor stops by itself, after 3 seconds
        with PX4 and at the end of `duration` with ArduPilot (MAV_CMD_DO_MOTOR_TEST, MAV_CMD_ACTUATOR_TEST).

        Args:
            number: The number of the motor, from 1. ArduPilot counts clockwise from the front right motor,
                PX4 by the functions of its outputs.
            throttle: Percent, 0 to 100.
            duration: Seconds, up to 600; PX4 gets the command again and again for a longer test than 3.
            wait: Wait until the motor has stopped. Without it a PX4 motor runs for 3 seconds at most.
            timeout: Seconds for the whole call; None sets no overall limit.

        Raises:
            InvalidTypeError: An argument is not a number.
            InvalidArgumentError: An argument is out of range.
            CommandDenied: The vehicle refused, such as while it is armed or in the air.
            CommandTimeout: The vehicle did not answer.
            ActionTimeout: The test did not end within `timeout`.
            ActionInterrupted: The vehicle was armed meanwhile.
            ContactLost: No heartbeat of the vehicle arrives.
            RemoteCancelled: The connection was closed.
        """
        _check_whole("motor number", number, 1, 32)
        _check_range("throttle", throttle, 0.0, 100.0)
        _check_range("duration", duration, 0.0, MAX_MOTOR_TEST)
        self._firmware("motor test")
        vehicle = self._vehicle
        async with ActionMonitor(vehicle, f"test of motor {number} of", timeout) as monitor:
            await self._run_motor(monitor, number, throttle, duration, wait=wait)

    async def _run_motor(
        self, monitor: ActionMonitor, number: int, throttle: float, duration: float, *, wait: bool
    ) -> None:
        vehicle = self._vehicle
        firmware, now = firmware_of(vehicle), vehicle.connection.now
        armed = None if firmware.MOTOR_TEST_ARMS else False
        end, started = now() + duration, False
        try:
            while (left := end - now()) > 0:
                if started and vehicle.armed and armed is False:
                    raise monitor.error(ActionInterrupted, "it was armed")
                step = min(left, firmware.MAX_MOTOR_TEST)
                await with_status_texts(vehicle, firmware.test_motor(number, throttle, step))
                started = True
                if not wait:
                    return
                until = end if step == left else now() + step - _OVERLAP
                goal = ActionGoal(lambda: now() >= until, armed=armed, stall_timeout=inf)  # noqa: B023
                await monitor.wait_until_reached(goal)
            await self._wait_until_disarmed(monitor)
        except BaseException:
            if started and vehicle.connection.is_open:
                firmware.stop_motor(number)
            raise

    async def _wait_until_disarmed(self, monitor: ActionMonitor) -> None:
        """Wait for the heartbeat after the test; a vehicle that stays armed was armed by another program."""
        vehicle, now = self._vehicle, self._vehicle.connection.now
        late = now() + _DISARMING_TIME
        goal = ActionGoal(lambda: not vehicle.armed or now() >= late, stall_timeout=inf)
        await monitor.wait_until_reached(goal)
        if vehicle.armed:
            raise monitor.error(ActionInterrupted, "it was armed")

    async def beep(self, tune: str = DEFAULT_TUNE) -> None:
        """Sound the beeper, so that a vehicle is found in the grass (PLAY_TUNE_V2); nothing acknowledges it.

        Args:
            tune: The tune, in the notation of QBasic's PLAY. Betaflight and iNav have one sound of their own.

        Raises:
            InvalidTypeError: The tune is not a text.
            InvalidArgumentError: The tune is empty, is not ASCII, or has more than 248 characters.
        """
        check_text("tune", tune)
        if not (0 < len(tune) <= MAX_TUNE and tune.isascii()):
            raise InvalidArgumentError(f"tune must have 1 to {MAX_TUNE} ASCII characters, got {tune!r}")
        self._vehicle.component.send(common.PlayTuneV2(format=common.TuneFormat.QBASIC1_1, tune=tune))

    # Gripper and winch

    async def grip(self, gripper: int = 1, *, timeout: float | None = None) -> None:
        """Close a gripper (MAV_CMD_DO_GRIPPER).

        Args:
            gripper: The number of the gripper, from 1.
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Raises:
            InvalidTypeError: The number is not a number.
            InvalidArgumentError: The number is out of range.
            CommandDenied: The vehicle refused, such as without a gripper.
            CommandTimeout: The vehicle did not answer.
            ActionTimeout: The call did not end within `timeout`.
        """
        await self._grip(gripper, _GRIP.GRAB, "closing", timeout)

    async def release(self, gripper: int = 1, *, timeout: float | None = None) -> None:
        """Open a gripper, which drops its cargo (MAV_CMD_DO_GRIPPER).

        Args:
            gripper: The number of the gripper, from 1.
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Raises:
            InvalidTypeError: The number is not a number.
            InvalidArgumentError: The number is out of range.
            CommandDenied: The vehicle refused, such as without a gripper.
            CommandTimeout: The vehicle did not answer.
            ActionTimeout: The call did not end within `timeout`.
        """
        await self._grip(gripper, _GRIP.RELEASE, "opening", timeout)

    async def unwind(
        self,
        length: float,
        *,
        rate: float = 0.0,
        winch: int = 1,
        wait: bool = True,
        timeout: float | None = None,
    ) -> None:
        """Pay out line from a winch, or wind it in, and wait until it has its length (MAV_CMD_DO_WINCH).

        The length is that of WINCH_STATUS; a vehicle that does not send it is not waited for.

        Args:
            length: Metres of line to pay out; negative: to wind in.
            rate: Metres per second; 0 leaves it to the vehicle.
            winch: The number of the winch, from 1.
            wait: Wait until the line has its length, or is wound in completely.
            timeout: Seconds for the whole call; None: until retries are exhausted or progress stalls.

        Raises:
            InvalidTypeError: An argument is not a number.
            InvalidArgumentError: An argument is not finite, or the rate is negative.
            CommandDenied: The vehicle refused, such as without a winch.
            CommandTimeout: The vehicle did not answer.
            ActionTimeout: The line stopped, or did not have its length within `timeout`.
            ContactLost: No heartbeat of the vehicle arrives.
            RemoteCancelled: The connection was closed.
        """
        check_number("length", length)
        _check_range("rate", rate, 0.0, inf)
        request = self._wind(winch, _WINCH.RELATIVE_LENGTH_CONTROL, length, rate)
        await winching.unwind(self._vehicle, winch, request, length, wait=wait, timeout=timeout)

    async def run_winch(
        self, rate: float, *, winch: int = 1, wait: bool = True, timeout: float | None = None
    ) -> None:
        """Run a winch at a rate until the next command, and wait until it moves (MAV_CMD_DO_WINCH).

        The speed is that of WINCH_STATUS; a vehicle that does not send it is not waited for.

        Args:
            rate: Metres of line per second to pay out; negative: to wind in; 0: stop.
            winch: The number of the winch, from 1.
            wait: Wait until the winch moves; for a rate of 0, until it stands still.
            timeout: Seconds for the whole call; None: until retries are exhausted or nothing moves.

        Raises:
            InvalidTypeError: An argument is not a number.
            InvalidArgumentError: The rate is not finite.
            CommandDenied: The vehicle refused, such as without a winch.
            CommandTimeout: The vehicle did not answer.
            ActionTimeout: The winch did not start, or did not stop, in time.
            ContactLost: No heartbeat of the vehicle arrives.
            RemoteCancelled: The connection was closed.
        """
        check_number("rate", rate)
        request = self._wind(winch, _WINCH.RATE_CONTROL, 0.0, rate)
        await winching.run(self._vehicle, winch, request, rate, wait=wait, timeout=timeout)

    async def relax_winch(self, winch: int = 1, *, timeout: float | None = None) -> None:
        """Let the line of a winch run freely (MAV_CMD_DO_WINCH); no message reports that it does.

        Args:
            winch: The number of the winch, from 1.
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Raises:
            InvalidTypeError: The number is not a number.
            InvalidArgumentError: The number is out of range.
            CommandDenied: The vehicle refused, such as without a winch.
            CommandTimeout: The vehicle did not answer.
            ActionTimeout: The call did not end within `timeout`.
        """
        request = self._wind(winch, _WINCH.RELAXED, 0.0, 0.0)
        await self._request(f"running winch {winch} of", request, timeout)

    async def _grip(self, gripper: int, action: int, verb: str, timeout: float | None) -> None:
        _check_whole("gripper number", gripper, 1, 255)
        self._firmware("gripper")
        command = self._vehicle.component.command(_CMD.DO_GRIPPER, gripper, action)
        await self._request(f"{verb} gripper {gripper} of", command, timeout)

    def _wind(self, winch: int, action: int, length: float, rate: float) -> Coroutine[Any, Any, object]:
        _check_whole("winch number", winch, 1, 255)
        self._firmware("winch")
        return self._vehicle.component.command(_CMD.DO_WINCH, winch, action, length, rate)

    def _firmware(self, call: str) -> Firmware:
        """Return the firmware; raise `ActionUnsupported` if it lacks a call."""
        firmware = firmware_of(self._vehicle)
        firmware.check_supported(call)
        check_preconditions(self._vehicle, "outputs", f"using the {call} of")
        return firmware

    async def _request(
        self, operation: str, request: Coroutine[Any, Any, object], timeout: float | None
    ) -> None:
        async with deadline(timeout, operation, self._vehicle.address):
            await with_status_texts(self._vehicle, request)


def _check_whole(name: str, value: float, minimum: int, maximum: int) -> None:
    """Raise unless a value is a whole number in a range."""
    check_number(name, value)
    if value != int(value) or not minimum <= value <= maximum:
        raise InvalidArgumentError(f"{name} must be a whole number from {minimum} to {maximum}, got {value}")


def _check_range(name: str, value: float, minimum: float, maximum: float) -> None:
    """Raise unless a value is a number in a range."""
    check_number(name, value)
    if not minimum <= value <= maximum:
        limits = f"at least {minimum:g}" if maximum == inf else f"{minimum:g} to {maximum:g}"
        raise InvalidArgumentError(f"{name} must be {limits}, got {value:g}")

"""A vehicle: its state, and the actions that it can take.

All calls go to the vehicle's autopilot. `component` is that autopilot with every MAVLink service, for the
calls that are missing here; `firmware` holds the differences of its firmware.

An action waits until it is complete, unless `wait=False`, and then raises `ActionTimeout` if its progress
stalls, `ActionInterrupted` if the vehicle leaves it, `ContactLost` if no heartbeat arrives. A refusal raises
`CommandDenied` with the vehicle's status texts, or `ActionRefused` before anything is sent; the vehicle is
then as it was before the call. Altitudes are in metres above home, angles in degrees.
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

from mavstack.errors import InvalidArgumentError
from mavstack.services import DEFAULT_WAIT_TIMEOUT
from mavstack.services.arguments import check_number
from mavstack.services.mission import PlanType
from mavstack.vehicle.actions import arming, home, readiness
from mavstack.vehicle.actions.preconditions import check_preconditions
from mavstack.vehicle.actions.renumber import Renumbered, renumber
from mavstack.vehicle.actuators import Actuators
from mavstack.vehicle.calibration import Calibration
from mavstack.vehicle.capabilities import Capabilities, capabilities_of
from mavstack.vehicle.deadline import deadline
from mavstack.vehicle.firmware import Firmware, firmware_of
from mavstack.vehicle.flight import FlightActions
from mavstack.vehicle.guided_session import STANDING_STILL, GuidedSession
from mavstack.vehicle.mission import Mission, VehiclePlan
from mavstack.vehicle.roi import RegionOfInterest
from mavstack.vehicle.status_text_capture import with_status_texts

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.services.command import CommandResult
    from mavstack.services.setpoints import Setpoint
    from mavstack.services.version import AutopilotVersion
    from mavstack.vehicle.health import Health


class Vehicle(FlightActions):
    """One vehicle; made by `Connection.wait_for_vehicle` and found in `Connection.vehicles`."""

    @property
    def firmware(self) -> Firmware:
        """The firmware's way to take commands, by the MAV_AUTOPILOT of the heartbeat."""
        return firmware_of(self)

    @property
    def capabilities(self) -> Capabilities:
        """The capabilities as far as they are known now; `get_version` requests AUTOPILOT_VERSION."""
        return capabilities_of(self)

    async def wait_until_ready(
        self,
        *,
        mode: str | None = None,
        keep_mode: bool = False,
        timeout: float | None = DEFAULT_WAIT_TIMEOUT,
    ) -> Health:
        """Wait until the vehicle will accept arming.

        A disarmed vehicle leaves a mode in which its firmware does not arm, such as the one that it landed
        in, as `arm` does. A disarmed PX4 vehicle without radio control leaves a mode that needs sticks for
        its hold mode.
        A vehicle that does not report its checks, such as ArduPilot before 4.1, is ready when it has a
        position and has reported no problem for some seconds.

        Args:
            mode: The name of the mode to be flown, such as "ALT_HOLD"; None: one that needs a position, as
                takeoff and all other actions do; a submarine needs one only for a mode that is named here.
            keep_mode: Change no mode; then a vehicle in such a mode does not get ready.
            timeout: Seconds to wait; None waits for ever.

        Returns:
            The health of the ready vehicle; its `ready` is None if the vehicle does not report its checks.

        Raises:
            HealthTimeout: The vehicle was not ready in time; the text holds its problems.
            RemoteCancelled: The connection was closed.
        """
        return await readiness.wait_until_ready(self, mode, timeout, keep_mode=keep_mode)

    # Arming and modes

    async def arm(
        self,
        *,
        force: bool = False,
        allow_flight: bool = False,
        keep_mode: bool = False,
        timeout: float | None = None,
    ) -> None:
        """Arm the vehicle: let its motors run (MAV_CMD_COMPONENT_ARM_DISARM).

        A vehicle stays in RTL, LAND or AUTO after its landing, where most firmwares do not arm. Then it first
        enters the mode in which it waits on the ground: GUIDED (ArduPilot's copters), FBWA (planes), HOLD
        (rovers) or LOITER (PX4). In a mode that starts by itself, such as TAKEOFF or MISSION, arming is
        refused. If the vehicle refuses to arm, its mode is restored.

        Args:
            force: Skip the firmware's checks, as far as it allows that.
            allow_flight: Arm in a mode in which the vehicle starts to fly or drive at once.
            keep_mode: Refuse instead of leaving a mode in which the firmware does not arm.
            timeout: Seconds for the whole call; None: until retries are exhausted or progress stalls.

        Raises:
            ActionRefused: The mode would start a flight, or does not allow arming; nothing was sent.
            CommandDenied: The vehicle refused; the text holds the failed checks.
            CommandTimeout: The vehicle did not answer.
            ActionTimeout: The vehicle accepted, and its heartbeat did not confirm it in time.
            ContactLost: No heartbeat of the vehicle arrives.
            RemoteCancelled: The connection was closed, or a disarming came before the vehicle armed.
        """
        await arming.arm(self, force=force, allow_flight=allow_flight, keep_mode=keep_mode, timeout=timeout)

    async def disarm(self, *, force: bool = False, timeout: float | None = None) -> None:
        """Disarm the vehicle: stop its motors (MAV_CMD_COMPONENT_ARM_DISARM).

        Args:
            force: Stop the motors even in the air.
            timeout: Seconds for the whole call; None: until retries are exhausted or progress stalls.

        Raises:
            CommandDenied: The vehicle refused, such as in the air.
            CommandTimeout: The vehicle did not answer.
            ActionTimeout: The vehicle accepted, and its heartbeat did not confirm it in time.
            ContactLost: No heartbeat of the vehicle arrives.
            RemoteCancelled: The connection was closed.
        """
        await arming.disarm(self, force=force, timeout=timeout)

    async def set_mode(self, mode: str | int, *, timeout: float | None = None) -> None:
        """Set the flight mode (MAV_CMD_DO_SET_MODE), and wait until the heartbeat confirms it.

        Args:
            mode: The name of a mode of the firmware, or its custom mode number; `modes.list()` returns them.
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Raises:
            CommandDenied: The vehicle refused the mode, or has none of that name.
            CommandTimeout: The vehicle did not answer.
            ModeTimeout: The vehicle accepted the mode and did not enter it.
        """
        check_preconditions(self, "mode", "setting the mode of")
        await with_status_texts(self, self.component.modes.set(mode, timeout=timeout))

    # Any command, and the firmware's version

    async def command(
        self,
        command: int,
        *params: float,
        frame: int | None = None,
        timeout: float | None = None,
        progress: Callable[[int, int], None] | None = None,
    ) -> CommandResult:
        """Send any MAV_CMD to the autopilot, and wait for its end; errors carry the vehicle's status texts.

        Args:
            command: The MAV_CMD.
            params: Up to seven parameters, in the units of the command's definition; missing ones are 0.
            frame: A MAV_FRAME: send COMMAND_INT, with params 5 and 6 in degrees or metres. None:
                COMMAND_LONG.
            timeout: Seconds for the whole call; None: until retries are exhausted or no more IN_PROGRESS is
                received.
            progress: Called with the percentage done and 100 while a long command runs.

        Returns:
            The result and its additional data (COMMAND_ACK).

        Raises:
            CommandDenied: The vehicle answered with another result than ACCEPTED.
            CommandTimeout: The vehicle did not answer.
            RemoteCancelled: The connection was closed.
        """
        check_preconditions(self, "command", "sending a command to")
        request = self.component.command(command, *params, frame=frame, timeout=timeout, progress=progress)
        return await with_status_texts(self, request)

    async def get_version(self, *, timeout: float | None = None) -> AutopilotVersion:
        """Get the software and hardware versions and the capabilities (AUTOPILOT_VERSION).

        Args:
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Returns:
            The versions, the unique id and the MAV_PROTOCOL_CAPABILITY flags; `version` keeps them.

        Raises:
            CommandDenied: The vehicle refused the request.
            MessageTimeout: The vehicle did not answer.
        """
        return await with_status_texts(self, self.component.get_version(timeout=timeout))

    async def set_ekf_source(self, number: int, *, timeout: float | None = None) -> None:
        """Select a set of sources of the state estimator (MAV_CMD_SET_EKF_SOURCE_SET).

        Args:
            number: The number of the set, 1 to 3: parameters EK3_SRC1_… to EK3_SRC3_….
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Raises:
            InvalidTypeError: The number is not a number.
            InvalidArgumentError: The number is not 1, 2 or 3.
            ActionUnsupported: The firmware has no source sets (PX4); nothing was sent.
            CommandDenied: The vehicle refused.
            CommandTimeout: The vehicle did not answer.
            ActionTimeout: The call did not end within `timeout`.
        """
        check_number("source set", number)
        if number not in (1, 2, 3):
            raise InvalidArgumentError(f"source set must be 1, 2 or 3, got {number}")
        operation = "selecting the estimator's sources of"
        check_preconditions(self, "ekf sources", operation)
        async with deadline(timeout, operation, self.address):
            await with_status_texts(self, self.firmware.set_ekf_source(number))

    # Setpoints

    def guided(
        self, rate: float = 20.0, first: Setpoint = STANDING_STILL, *, timeout: float | None = None
    ) -> GuidedSession:
        """Return a context manager during which the vehicle follows setpoints.

        Args:
            rate: The rate at which the last setpoint is sent, in hertz.
            first: The setpoint at the start; the default stays where the vehicle is, which a wing cannot do:
                it needs another one, such as an `AttitudeSetpoint`.
            timeout: Seconds to enter the mode; None: until retries are exhausted.

        Returns:
            The session. Entering it raises `ActionRefused` if the vehicle is not armed, and `CommandDenied`,
            `CommandTimeout`, `ModeTimeout`, `ActionTimeout` or `ActionUnsupported` if it does not enter the
            mode; the last one, before anything is sent, also if it ignores setpoints of the type of `first`.
        """
        return GuidedSession(self, rate, first, timeout)

    # Home, and reboots

    async def set_home(
        self,
        latitude: float | None = None,
        longitude: float | None = None,
        altitude: float | None = None,
        *,
        timeout: float | None = None,
    ) -> None:
        """Set the home position (MAV_CMD_DO_SET_HOME).

        Args:
            latitude: Degrees; None with `longitude` None: the present position.
            longitude: Degrees.
            altitude: Metres above mean sea level; None keeps the altitude of home.
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Raises:
            InvalidArgumentError: Only one of latitude and longitude is given.
            CommandDenied: The vehicle refused.
            CommandTimeout: The vehicle did not answer.
            MessageTimeout: `altitude` is None, and the altitude of home is not known.
            ActionTimeout: The call did not end within `timeout`.
        """
        await home.set_home(self, latitude, longitude, altitude, timeout)

    async def reboot(self, *, wait: bool = True, timeout: float | None = None) -> None:
        """Reboot the autopilot (MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN).

        Args:
            wait: Wait until the autopilot is back.
            timeout: Seconds for the whole call; None: until retries are exhausted, or it stays away.

        Raises:
            CommandDenied: The vehicle refused, such as in the air.
            CommandTimeout: The vehicle did not answer.
            ContactLost: Without `wait`: the vehicle fell silent and did not acknowledge.
            ActionTimeout: The vehicle did not come back in time.
            RemoteCancelled: The connection was closed.
        """
        await arming.reboot(self, wait=wait, timeout=timeout)

    async def renumber(self, system: int | None = None, *, timeout: float | None = None) -> Renumbered:
        """Give the vehicle another system id, reboot it if that is needed, and wait until it speaks with it.

        Where several vehicles use its system id, choose one with `choose_sender` first.

        Args:
            system: The new system id, 1 to 255; None: the lowest one that no component uses.
            timeout: Seconds for the whole call; None: until retries are exhausted, or it stays away.

        Returns:
            The new system id, the parameter, and whether the vehicle rebooted.

        Raises:
            SystemIdConflictError: Several vehicles use its system id, and none was chosen.
            InvalidArgumentError: The system id is out of range, or a component uses it.
            InvalidStateError: The vehicle is armed.
            ActionUnsupported: The firmware's parameter is not known.
            ParameterDenied: The vehicle refused the parameter.
            CommandDenied: The vehicle refused to reboot.
            ActionTimeout: It has no such parameter, or did not speak with the new system id in time.
        """
        return await renumber(self, system, timeout)

    # Outputs, payload and calibrations

    @cached_property
    def actuators(self) -> Actuators:
        """The outputs: servos, relays, actuators, motor tests, gripper and winch."""
        return Actuators(self)

    @cached_property
    def calibration(self) -> Calibration:
        """The calibrations of the sensors, the radio control and the motors."""
        return Calibration(self)

    @cached_property
    def roi(self) -> RegionOfInterest:
        """The region of interest: the point that the gimbal or the nose keeps pointing at."""
        return RegionOfInterest(self)

    # Services

    @cached_property
    def mission(self) -> Mission:
        """The mission."""
        return Mission(self)

    @cached_property
    def fence(self) -> VehiclePlan:
        """The geofence."""
        return VehiclePlan(self, PlanType.FENCE)

    @cached_property
    def rally(self) -> VehiclePlan:
        """The rally points."""
        return VehiclePlan(self, PlanType.RALLY)

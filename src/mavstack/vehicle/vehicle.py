"""A vehicle: its state, and the actions that it can take.

All calls go to the vehicle's autopilot. `component` is that autopilot with every MAVLink service, for the
calls that are missing here; `firmware` holds the differences of its firmware.

An action waits until it is complete, unless `wait=False`, and then raises `ActionTimeout` if its progress
stalls, `ActionInterrupted` if the vehicle leaves it, `ContactLost` if no heartbeat arrives. A refusal raises
`CommandDenied` with the vehicle's status texts. Altitudes are in metres above home, angles in degrees.
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.services import DEFAULT_WAIT_TIMEOUT
from mavstack.services.mission import PlanType
from mavstack.vehicle.actions import arming, flying, home, readiness
from mavstack.vehicle.firmware import Firmware, firmware_of
from mavstack.vehicle.geography import Location
from mavstack.vehicle.guided_session import STANDING_STILL, GuidedSession
from mavstack.vehicle.mission import Mission, VehiclePlan
from mavstack.vehicle.status_text_capture import with_status_texts
from mavstack.vehicle.vehicle_state import VehicleState

if TYPE_CHECKING:
    from mavstack.services.setpoints import Setpoint
    from mavstack.vehicle.health import Health


class Vehicle(VehicleState):
    """One vehicle; made by `Connection.wait_for_vehicle` and found in `Connection.vehicles`."""

    @property
    def firmware(self) -> Firmware:
        """The firmware's way to take commands, by the MAV_AUTOPILOT of the heartbeat."""
        return firmware_of(self)

    async def wait_until_ready(self, *, timeout: float | None = DEFAULT_WAIT_TIMEOUT) -> Health:
        """Wait until the vehicle reports that it is ready to arm.

        Args:
            timeout: Seconds to wait; None waits for ever.

        Returns:
            The health of the ready vehicle.

        Raises:
            HealthTimeout: The vehicle was not ready in time; the text holds its problems.
            RemoteCancelled: The connection was closed.
        """
        return await readiness.wait_until_ready(self, timeout)

    # Arming and modes

    async def arm(self, *, force: bool = False, timeout: float | None = None) -> None:
        """Arm the vehicle: let its motors run (MAV_CMD_COMPONENT_ARM_DISARM).

        Args:
            force: Skip the firmware's checks, as far as it allows that.
            timeout: Seconds for the whole call; None: until retries are exhausted or progress stalls.

        Raises:
            CommandDenied: The vehicle refused; the text holds the failed checks.
            CommandTimeout: The vehicle did not answer.
            ActionTimeout: The vehicle accepted, and its heartbeat did not confirm it in time.
            ContactLost: No heartbeat of the vehicle arrives.
            RemoteCancelled: The connection was closed.
        """
        await arming.set_armed(self, armed=True, force=force, timeout=timeout)

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
        await arming.set_armed(self, armed=False, force=force, timeout=timeout)

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
        await with_status_texts(self, self.component.modes.set(mode, timeout=timeout))

    # Flying

    async def takeoff(
        self, altitude: float = 10.0, *, wait: bool = True, timeout: float | None = None
    ) -> None:
        """Take off to an altitude and stay there; the vehicle must be armed.

        Args:
            altitude: Metres above home.
            wait: Wait until the altitude is reached.
            timeout: Seconds for the whole call; None sets no overall limit.

        Raises:
            InvalidArgumentError: The altitude is not positive and finite.
            CommandDenied: The vehicle refused; the text holds its status texts.
            CommandTimeout: The vehicle did not answer.
            ModeTimeout: The vehicle accepted a mode and did not enter it.
            ActionUnsupported: The vehicle type or the firmware does not support it; nothing was sent.
            ActionTimeout: It was not complete within `timeout`, or its progress stalled.
            ActionInterrupted: The vehicle changed its mode or was disarmed meanwhile.
            ContactLost: No heartbeat of the vehicle arrives.
            RemoteCancelled: The connection was closed.
        """
        await flying.takeoff(self, altitude, wait=wait, timeout=timeout)

    async def land(self, *, wait: bool = True, timeout: float | None = None) -> None:
        """Land at the present position; an ArduPilot plane lands where its mission tells it to.

        Args:
            wait: Wait until the vehicle has landed.
            timeout: Seconds for the whole call; None sets no overall limit.

        Raises:
            CommandDenied: The vehicle refused; the text holds its status texts.
            CommandTimeout: The vehicle did not answer.
            ModeTimeout: The vehicle accepted a mode and did not enter it.
            ActionUnsupported: The vehicle type or the firmware does not support it; nothing was sent.
            ActionTimeout: It was not complete within `timeout`, or its progress stalled.
            ActionInterrupted: The vehicle changed its mode or was disarmed meanwhile.
            ContactLost: No heartbeat of the vehicle arrives.
            RemoteCancelled: The connection was closed.
        """
        await flying.land(self, wait=wait, timeout=timeout)

    async def rtl(self, *, wait: bool = True, timeout: float | None = None) -> None:
        """Return to home, and land there if the vehicle does that.

        Args:
            wait: Wait until the vehicle has landed, or has arrived where it does not land.
            timeout: Seconds for the whole call; None sets no overall limit.

        Raises:
            CommandDenied: The vehicle refused; the text holds its status texts.
            CommandTimeout: The vehicle did not answer.
            ModeTimeout: The vehicle accepted a mode and did not enter it.
            ActionUnsupported: The vehicle type or the firmware does not support it; nothing was sent.
            ActionTimeout: It was not complete within `timeout`, or its progress stalled.
            ActionInterrupted: The vehicle changed its mode or was disarmed meanwhile.
            ContactLost: No heartbeat of the vehicle arrives.
            RemoteCancelled: The connection was closed.
        """
        await flying.rtl(self, wait=wait, timeout=timeout)

    async def hold(self, *, timeout: float | None = None) -> None:
        """Hold the present position; a wing circles.

        Args:
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Raises:
            CommandDenied: The vehicle refused the mode.
            CommandTimeout: The vehicle did not answer.
            ModeTimeout: The vehicle accepted the mode and did not enter it.
            ActionTimeout: The call did not end within `timeout`.
        """
        await flying.hold(self, timeout=timeout)

    async def goto(
        self,
        latitude: float,
        longitude: float,
        altitude: float | None = None,
        *,
        yaw: float | None = None,
        radius: float | None = None,
        wait: bool = True,
        timeout: float | None = None,
    ) -> None:
        """Go to a global position and stay there (MAV_CMD_DO_REPOSITION).

        Args:
            latitude: Degrees.
            longitude: Degrees.
            altitude: Metres above home; None keeps the present altitude.
            yaw: Heading in degrees; None leaves it to the vehicle.
            radius: Metres of the circle that a wing flies around the position; None: the vehicle's default.
            wait: Wait until the vehicle has arrived.
            timeout: Seconds for the whole call; None sets no overall limit.

        Raises:
            InvalidArgumentError: The position is not one on Earth.
            CommandDenied: The vehicle refused; the text holds its status texts.
            CommandTimeout: The vehicle did not answer.
            ModeTimeout: The vehicle accepted a mode and did not enter it.
            ActionUnsupported: The vehicle type or the firmware does not support it; nothing was sent.
            ActionTimeout: It was not complete within `timeout`, or its progress stalled.
            ActionInterrupted: The vehicle changed its mode or was disarmed meanwhile.
            ContactLost: No heartbeat of the vehicle arrives.
            RemoteCancelled: The connection was closed.
        """
        location = Location(latitude, longitude, altitude)
        await flying.goto(self, location, yaw=yaw, radius=radius, wait=wait, timeout=timeout)

    async def move(
        self,
        north: float = 0.0,
        east: float = 0.0,
        up: float = 0.0,
        *,
        wait: bool = True,
        timeout: float | None = None,
    ) -> None:
        """Move by a distance from the present position (MAV_CMD_DO_REPOSITION).

        Args:
            north: Metres to the north.
            east: Metres to the east.
            up: Metres upwards.
            wait: Wait until the vehicle has arrived.
            timeout: Seconds for the whole call; None sets no overall limit.

        Raises:
            MessageTimeout: The vehicle did not report its position.
            CommandDenied: The vehicle refused; the text holds its status texts.
            CommandTimeout: The vehicle did not answer.
            ModeTimeout: The vehicle accepted a mode and did not enter it.
            ActionUnsupported: The vehicle type or the firmware does not support it; nothing was sent.
            ActionTimeout: It was not complete within `timeout`, or its progress stalled.
            ActionInterrupted: The vehicle changed its mode or was disarmed meanwhile.
            ContactLost: No heartbeat of the vehicle arrives.
            RemoteCancelled: The connection was closed.
        """
        await flying.move(self, (north, east, up), wait=wait, timeout=timeout)

    async def orbit(
        self,
        latitude: float,
        longitude: float,
        altitude: float | None = None,
        *,
        radius: float = 20.0,
        speed: float | None = None,
        wait: bool = True,
        timeout: float | None = None,
    ) -> None:
        """Circle a global position (MAV_CMD_DO_ORBIT, or the firmware's mode for it).

        Args:
            latitude: Degrees.
            longitude: Degrees.
            altitude: Metres above home; None keeps the present altitude.
            radius: Metres; negative: counter-clockwise.
            speed: Metres per second; None leaves it to the vehicle.
            wait: Wait until the vehicle is on the circle.
            timeout: Seconds for the whole call; None sets no overall limit.

        Raises:
            InvalidArgumentError: The position is not one on Earth, or the radius is 0 or not finite.
            CommandDenied: The vehicle refused; the text holds its status texts.
            CommandTimeout: The vehicle did not answer.
            ModeTimeout: The vehicle accepted a mode and did not enter it.
            ActionUnsupported: The vehicle type or the firmware does not support it; nothing was sent.
            ActionTimeout: It was not complete within `timeout`, or its progress stalled.
            ActionInterrupted: The vehicle changed its mode or was disarmed meanwhile.
            ContactLost: No heartbeat of the vehicle arrives.
            RemoteCancelled: The connection was closed.
        """
        center = Location(latitude, longitude, altitude)
        await flying.orbit(self, center, radius=radius, speed=speed, wait=wait, timeout=timeout)

    async def set_speed(
        self, speed: float, speed_type: int = common.SpeedType.GROUNDSPEED, *, timeout: float | None = None
    ) -> None:
        """Set the speed of flight (MAV_CMD_DO_CHANGE_SPEED).

        Args:
            speed: Metres per second.
            speed_type: The SPEED_TYPE; the default is the speed over ground.
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Raises:
            CommandDenied: The vehicle refused.
            CommandTimeout: The vehicle did not answer.
        """
        command = self.component.command(
            common.MavCmd.DO_CHANGE_SPEED, speed_type, speed, -1, timeout=timeout
        )
        await with_status_texts(self, command)

    async def set_yaw(self, heading: float, *, wait: bool = True, timeout: float | None = None) -> None:
        """Turn to a heading on the spot.

        Args:
            heading: Degrees clockwise from north.
            wait: Wait until the vehicle has turned.
            timeout: Seconds for the whole call; None sets no overall limit.

        Raises:
            CommandDenied: The vehicle refused; the text holds its status texts.
            CommandTimeout: The vehicle did not answer.
            ModeTimeout: The vehicle accepted a mode and did not enter it.
            ActionUnsupported: The vehicle type or the firmware does not support it; nothing was sent.
            ActionTimeout: It was not complete within `timeout`, or its progress stalled.
            ActionInterrupted: The vehicle changed its mode or was disarmed meanwhile.
            ContactLost: No heartbeat of the vehicle arrives.
            RemoteCancelled: The connection was closed.
        """
        await flying.turn(self, heading, wait=wait, timeout=timeout)

    def guided(
        self, rate: float = 20.0, first: Setpoint = STANDING_STILL, *, timeout: float | None = None
    ) -> GuidedSession:
        """Return a context manager during which the vehicle follows setpoints.

        Args:
            rate: The rate at which the last setpoint is sent, in hertz.
            first: The setpoint at the start; the default stays where the vehicle is.
            timeout: Seconds to enter the mode; None: until retries are exhausted.

        Returns:
            The session. Entering it raises `CommandDenied`, `CommandTimeout`, `ModeTimeout`, `ActionTimeout`
            or `ActionUnsupported` if the vehicle does not enter the mode.
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

"""The flight actions of a vehicle, such as takeoff and goto; each is monitored until it is done."""

from __future__ import annotations

from mavstack.dialects import common
from mavstack.services.arguments import check_numbers
from mavstack.vehicle.actions import arming, flying
from mavstack.vehicle.actions.transition import transition
from mavstack.vehicle.firmware import firmware_of
from mavstack.vehicle.geography import Location
from mavstack.vehicle.status_text_capture import with_status_texts
from mavstack.vehicle.vehicle_state import VehicleState


class FlightActions(VehicleState):
    """The calls of a vehicle that fly it; part of `Vehicle`."""

    async def takeoff(
        self,
        altitude: float = 10.0,
        *,
        override_limits: bool = False,
        wait: bool = True,
        timeout: float | None = None,
    ) -> None:
        """Take off to an altitude and stay there; the vehicle must be armed.

        Args:
            altitude: Metres above home.
            override_limits: Send an altitude above the limit of plausible flights.
            wait: Wait until the altitude is reached.
            timeout: Seconds for the whole call; None sets no overall limit.

        Raises:
            InvalidTypeError: An argument is not a number.
            InvalidArgumentError: The altitude is not positive, or implausibly high.
            CommandDenied: The vehicle refused; the text holds its status texts.
            CommandTimeout: The vehicle did not answer.
            ModeTimeout: The vehicle accepted a mode and did not enter it.
            ActionUnsupported: The vehicle type or the firmware does not support it; nothing was sent.
            ActionTimeout: It was not complete within `timeout`, or its progress stalled.
            ActionInterrupted: The vehicle changed its mode or was disarmed meanwhile.
            ContactLost: No heartbeat of the vehicle arrives.
            RemoteCancelled: The connection was closed.
        """
        await flying.takeoff(self, altitude, override_limits=override_limits, wait=wait, timeout=timeout)

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
        override_limits: bool = False,
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
            override_limits: Send a position or an altitude that lies beyond the limits of plausible flights.
            wait: Wait until the vehicle has arrived.
            timeout: Seconds for the whole call; None sets no overall limit.

        Raises:
            InvalidTypeError: An argument is not a number.
            InvalidArgumentError: The position is not one on Earth, or implausibly far, high or low.
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
        await flying.goto(
            self,
            location,
            yaw=yaw,
            radius=radius,
            override_limits=override_limits,
            wait=wait,
            timeout=timeout,
        )

    async def move(
        self,
        north: float = 0.0,
        east: float = 0.0,
        up: float = 0.0,
        *,
        override_limits: bool = False,
        wait: bool = True,
        timeout: float | None = None,
    ) -> None:
        """Move by a distance from the present position (MAV_CMD_DO_REPOSITION).

        Args:
            north: Metres to the north.
            east: Metres to the east.
            up: Metres upwards.
            override_limits: Send a position or an altitude that lies beyond the limits of plausible flights.
            wait: Wait until the vehicle has arrived.
            timeout: Seconds for the whole call; None sets no overall limit.

        Raises:
            InvalidTypeError: An argument is not a number.
            InvalidArgumentError: The position is implausibly far, high or low.
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
        check_numbers(north=north, east=east, up=up)
        offset = (north, east, up)
        await flying.move(self, offset, override_limits=override_limits, wait=wait, timeout=timeout)

    async def orbit(
        self,
        latitude: float,
        longitude: float,
        altitude: float | None = None,
        *,
        radius: float = 20.0,
        speed: float | None = None,
        override_limits: bool = False,
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
            override_limits: Send a position or an altitude that lies beyond the limits of plausible flights.
            wait: Wait until the vehicle is on the circle.
            timeout: Seconds for the whole call; None sets no overall limit.

        Raises:
            InvalidTypeError: An argument is not a number.
            InvalidArgumentError: The position is not one on Earth, or implausible, or the radius is 0.
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
        await flying.orbit(
            self,
            center,
            radius=radius,
            speed=speed,
            override_limits=override_limits,
            wait=wait,
            timeout=timeout,
        )

    async def set_speed(
        self, speed: float, speed_type: int = common.SpeedType.GROUNDSPEED, *, timeout: float | None = None
    ) -> None:
        """Set the speed of flight (MAV_CMD_DO_CHANGE_SPEED).

        Args:
            speed: Metres per second.
            speed_type: The SPEED_TYPE; the default is the speed over ground.
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Raises:
            InvalidTypeError: The speed is not a number.
            InvalidArgumentError: The speed is not finite.
            CommandDenied: The vehicle refused.
            CommandTimeout: The vehicle did not answer.
        """
        check_numbers(speed=speed, speed_type=speed_type)
        firmware_of(self).check_supported("speed")
        command = self.component.command(
            common.MavCmd.DO_CHANGE_SPEED, speed_type, speed, -1, timeout=timeout
        )
        await with_status_texts(self, command)

    async def set_yaw(self, heading: float, *, wait: bool = True, timeout: float | None = None) -> None:
        """Turn to a heading on the spot.

        Args:
            heading: Degrees clockwise from north; 500 is the same as 140.
            wait: Wait until the vehicle has turned.
            timeout: Seconds for the whole call; None sets no overall limit.

        Raises:
            InvalidTypeError: The heading is not a number.
            InvalidArgumentError: The heading is not finite.
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

    async def transition_to_fixed_wing(self, *, wait: bool = True, timeout: float | None = None) -> None:
        """Change a VTOL that hovers to flight on its wing (MAV_CMD_DO_VTOL_TRANSITION).

        Args:
            wait: Wait until the vehicle flies on its wing.
            timeout: Seconds for the whole call; None sets no overall limit.

        Raises:
            CommandDenied: The vehicle refused, such as on the ground or in a mode without forward flight.
            CommandTimeout: The vehicle did not answer.
            ActionUnsupported: The vehicle is no VTOL; nothing was sent.
            ActionTimeout: It was not complete within `timeout`, or within a minute.
            ActionInterrupted: The vehicle was disarmed meanwhile.
            ContactLost: No heartbeat of the vehicle arrives.
            RemoteCancelled: The connection was closed.
        """
        await transition(self, common.MavVtolState.FW, wait=wait, timeout=timeout)

    async def transition_to_multicopter(self, *, wait: bool = True, timeout: float | None = None) -> None:
        """Change a VTOL that flies on its wing to hovering (MAV_CMD_DO_VTOL_TRANSITION).

        Args:
            wait: Wait until the vehicle hovers.
            timeout: Seconds for the whole call; None sets no overall limit.

        Raises:
            CommandDenied: The vehicle refused, such as on the ground.
            CommandTimeout: The vehicle did not answer.
            ActionUnsupported: The vehicle is no VTOL; nothing was sent.
            ActionTimeout: It was not complete within `timeout`, or within a minute.
            ActionInterrupted: The vehicle was disarmed meanwhile.
            ContactLost: No heartbeat of the vehicle arrives.
            RemoteCancelled: The connection was closed.
        """
        await transition(self, common.MavVtolState.MC, wait=wait, timeout=timeout)

    async def terminate(self, *, timeout: float | None = None) -> None:
        """Terminate the flight: stop the motors permanently, wherever the vehicle is. It crashes.

        Only a reboot ends the termination. ArduPilot may need AFS_ENABLE for it
        (MAV_CMD_DO_FLIGHTTERMINATION).

        Args:
            timeout: Seconds for the whole call; None: until retries are exhausted or progress stalls.

        Raises:
            CommandDenied: The vehicle refused, such as PX4 while it is disarmed.
            CommandTimeout: The vehicle did not answer.
            ActionTimeout: The vehicle accepted, and its heartbeat did not confirm it in time.
            ContactLost: No heartbeat of the vehicle arrives.
            RemoteCancelled: The connection was closed.
        """
        await arming.terminate(self, timeout=timeout)

"""The flight actions of a vehicle, such as takeoff and goto; each is monitored until it is done."""

from __future__ import annotations

from mavstack.dialects import common
from mavstack.services.arguments import check_numbers
from mavstack.vehicle.actions import arming, flying
from mavstack.vehicle.actions.preconditions import check_preconditions
from mavstack.vehicle.actions.takeoff import takeoff
from mavstack.vehicle.actions.transition import transition
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

        It ends when a vehicle that hovers has settled within half a metre of the altitude.

        Args:
            altitude: Metres above home.
            override_limits: Send an altitude above the limit of plausible flights.
            wait: Wait until the altitude is reached and kept.
            timeout: Seconds for the whole call; None sets no overall limit.

        Raises:
            InvalidTypeError: An argument is not a number.
            InvalidArgumentError: The altitude is not positive, or implausibly high.
            ActionRefused: The vehicle is not armed, or it flies and its firmware does not take off then
                (ArduPilot); nothing was sent.
            CommandDenied: The vehicle refused; it is as it was before, and the text holds its status texts.
            CommandTimeout: The vehicle did not answer.
            ModeTimeout: The vehicle accepted a mode and did not enter it.
            ActionUnsupported: The vehicle type or the firmware does not support it; nothing was sent.
            ActionTimeout: It was not complete within `timeout`, or its progress stalled.
            ActionInterrupted: The vehicle changed its mode or was disarmed meanwhile.
            ContactLost: No heartbeat of the vehicle arrives.
            RemoteCancelled: The connection was closed.
        """
        await takeoff(self, altitude, override_limits=override_limits, wait=wait, timeout=timeout)

    async def land(self, *, wait: bool = True, timeout: float | None = None) -> None:
        """Land at the present position; an ArduPilot plane lands where its mission tells it to.

        Args:
            wait: Wait until the vehicle has landed.
            timeout: Seconds for the whole call; None sets no overall limit.

        Raises:
            ActionRefused: The vehicle is not armed; nothing was sent.
            CommandDenied: The vehicle refused; it is as it was before, and the text holds its status texts.
            CommandTimeout: The vehicle did not answer.
            ModeTimeout: The vehicle accepted a mode and did not enter it.
            ActionUnsupported: The vehicle type or the firmware does not support it; nothing was sent.
            ActionTimeout: It was not complete within `timeout`, or its progress stalled.
            ActionInterrupted: The vehicle changed its mode or was disarmed meanwhile.
            ContactLost: No heartbeat of the vehicle arrives.
            RemoteCancelled: The connection was closed.
        """
        await flying.land(self, wait=wait, timeout=timeout)

    async def rtl(
        self, *, tolerance: float | None = None, wait: bool = True, timeout: float | None = None
    ) -> None:
        """Return to home, and land there if the vehicle does that.

        A plane has returned when it circles home and does not climb or sink any more.

        Args:
            tolerance: Metres from home at which a vehicle that does not land has arrived; None: see `goto`.
            wait: Wait until the vehicle has landed, or has arrived where it does not land.
            timeout: Seconds for the whole call; None sets no overall limit.

        Raises:
            ActionRefused: The vehicle is not armed; nothing was sent.
            CommandDenied: The vehicle refused; it is as it was before, and the text holds its status texts.
            CommandTimeout: The vehicle did not answer.
            ModeTimeout: The vehicle accepted a mode and did not enter it.
            ActionUnsupported: The vehicle type or the firmware does not support it; nothing was sent.
            ActionTimeout: It was not complete within `timeout`, or its progress stalled.
            ActionInterrupted: The vehicle changed its mode or was disarmed meanwhile.
            ContactLost: No heartbeat of the vehicle arrives.
            RemoteCancelled: The connection was closed.
        """
        await flying.rtl(self, tolerance=tolerance, wait=wait, timeout=timeout)

    async def hold(self, *, timeout: float | None = None) -> None:
        """Hold the present position; a wing circles.

        Args:
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Raises:
            ActionRefused: The vehicle is not armed; nothing was sent.
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
        tolerance: float | None = None,
        override_limits: bool = False,
        wait: bool = True,
        timeout: float | None = None,
    ) -> None:
        """Go to a global position and stay there (MAV_CMD_DO_REPOSITION).

        A vehicle that stops has arrived when it is within the tolerance and slow. By default that is 0.5 m
        for copters, submarines (0.2 m of depth) and rovers, 1 m for boats and hovering VTOLs; rovers and
        boats that stop within a larger radius by their parameters (WP_RADIUS, LOIT_RADIUS, NAV_ACC_RAD)
        arrive within it. Rovers and boats have no altitude. A wing has arrived when it circles the position
        within 5 m of the altitude, or within `tolerance`; with it, passing that closely is enough too.

        Args:
            latitude: Degrees.
            longitude: Degrees.
            altitude: Metres above home; None keeps the present altitude.
            yaw: Heading in degrees; None leaves it to the vehicle.
            radius: Metres of the circle that a wing flies around the position; None: the vehicle's default.
            tolerance: Metres from the position, over ground and in altitude, at which the vehicle has
                arrived; None: the default of its type.
            override_limits: Send a position or an altitude that lies beyond the limits of plausible flights.
            wait: Wait until the vehicle has arrived.
            timeout: Seconds for the whole call; None sets no overall limit.

        Raises:
            InvalidTypeError: An argument is not a number.
            InvalidArgumentError: The position is not one on Earth, or implausibly far, high or low.
            ActionRefused: The vehicle is not armed, or stands on the ground; nothing was sent.
            CommandDenied: The vehicle refused; it is as it was before, and the text holds its status texts.
            CommandTimeout: The vehicle did not answer.
            ModeTimeout: The vehicle accepted a mode and did not enter it.
            ActionUnsupported: The vehicle type or the firmware does not support it, such as a radius that the
                version ignores, or a tolerance below the radius within which it stops; nothing was changed.
            ActionTimeout: It was not complete within `timeout`, or its progress stalled, such as a vehicle
                that does not meet the tolerance; the text says by how much.
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
            tolerance=tolerance,
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
        tolerance: float | None = None,
        override_limits: bool = False,
        wait: bool = True,
        timeout: float | None = None,
    ) -> None:
        """Move by a distance from the present position (MAV_CMD_DO_REPOSITION).

        Args:
            north: Metres to the north.
            east: Metres to the east.
            up: Metres upwards; rovers and boats have no altitude.
            tolerance: Metres from the position at which the vehicle has arrived; None: as for `goto`.
            override_limits: Send a position or an altitude that lies beyond the limits of plausible flights.
            wait: Wait until the vehicle has arrived.
            timeout: Seconds for the whole call; None sets no overall limit.

        Raises:
            InvalidTypeError: An argument is not a number.
            InvalidArgumentError: The position is implausibly far, high or low.
            MessageTimeout: The vehicle did not report its position.
            ActionRefused: The vehicle is not armed, or stands on the ground; nothing was sent.
            CommandDenied: The vehicle refused; it is as it was before, and the text holds its status texts.
            CommandTimeout: The vehicle did not answer.
            ModeTimeout: The vehicle accepted a mode and did not enter it.
            ActionUnsupported: The vehicle type or the firmware does not support it, such as a change of
                altitude by a rover; nothing was changed.
            ActionTimeout: It was not complete within `timeout`, or its progress stalled, as for `goto`.
            ActionInterrupted: The vehicle changed its mode or was disarmed meanwhile.
            ContactLost: No heartbeat of the vehicle arrives.
            RemoteCancelled: The connection was closed.
        """
        check_numbers(north=north, east=east, up=up)
        offset = (north, east, up)
        await flying.move(
            self,
            offset,
            tolerance=tolerance,
            override_limits=override_limits,
            wait=wait,
            timeout=timeout,
        )

    async def orbit(
        self,
        latitude: float,
        longitude: float,
        altitude: float | None = None,
        *,
        radius: float = 20.0,
        speed: float | None = None,
        tolerance: float | None = None,
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
            tolerance: Metres by which radius and altitude may differ; None: a tenth of the radius, at
                least 1; on a wing a quarter of it, at least 10.
            override_limits: Send a position or an altitude that lies beyond the limits of plausible flights.
            wait: Wait until the vehicle is on the circle, in the direction that was asked for.
            timeout: Seconds for the whole call; None sets no overall limit.

        Raises:
            InvalidTypeError: An argument is not a number.
            InvalidArgumentError: The position is not one on Earth, or implausible, or the radius is 0.
            ActionRefused: The vehicle is not armed, or stands on the ground; nothing was sent.
            CommandDenied: The vehicle refused; it is as it was before, and the text holds its status texts.
            CommandTimeout: The vehicle did not answer.
            ModeTimeout: The vehicle accepted a mode and did not enter it.
            ActionUnsupported: The vehicle type or the firmware does not support it, such as a radius that the
                version ignores; the text names the parameter that sets it. Nothing was changed.
            ActionTimeout: It was not complete within `timeout`, its progress stalled, or the vehicle flies
                another circle, or the other way round.
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
            tolerance=tolerance,
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
        check_preconditions(self, "speed", "setting the speed of")
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
            ActionRefused: The vehicle is not armed, or stands on the ground; nothing was sent.
            CommandDenied: The vehicle refused; it is as it was before, and the text holds its status texts.
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
            ActionRefused: The vehicle is not armed, or stands on the ground; nothing was sent.
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
            ActionRefused: The vehicle is not armed, or stands on the ground; nothing was sent.
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

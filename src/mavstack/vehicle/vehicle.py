"""A vehicle: its state, and the actions that it can take.

All calls go to the vehicle's autopilot. `component` is that autopilot with every MAVLink service, for the
calls that are missing here; `firmware` holds the differences of its firmware.

The class is composed: its parts, such as the mission, are rows of the class body, and its calls are functions
of the modules of their subjects, bound as methods. Each call is declared once, where it is implemented.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

from mavstack.dialects import Message, common
from mavstack.node.api_object import ReadOnly
from mavstack.node.parts import Part
from mavstack.node.subscription import DEFAULT_QUEUE
from mavstack.services.events import LogLevel
from mavstack.services.mission import PlanType
from mavstack.vehicle import following, guided_session, payloads, positions
from mavstack.vehicle.actions import (
    arming,
    commands,
    flying,
    home,
    landing,
    readiness,
    renumber,
    takeoff,
    transition,
)
from mavstack.vehicle.actuators import Actuators
from mavstack.vehicle.calibration import Calibration
from mavstack.vehicle.capabilities import Capabilities, capabilities_of
from mavstack.vehicle.devices import Devices
from mavstack.vehicle.external import External
from mavstack.vehicle.firmware import Firmware, firmware_of
from mavstack.vehicle.health import Health, health_of
from mavstack.vehicle.mission import Mission, VehiclePlan
from mavstack.vehicle.roi import RegionOfInterest
from mavstack.vehicle.rtk import Rtk
from mavstack.vehicle.telemetry import Telemetry, messages, readers, value_streams
from mavstack.vehicle.transponder import Transponder
from mavstack.vehicle.vehicle_type import QUADPLANE_PARAMETER, VehicleType

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from mavstack.links import Channel
    from mavstack.node import Node, RemoteComponent
    from mavstack.node.camera import Camera
    from mavstack.node.events import EventListener, EventStream
    from mavstack.node.failure import Failure
    from mavstack.node.ftp import Ftp
    from mavstack.node.gimbal import Gimbal
    from mavstack.node.log_stream import LogStreams
    from mavstack.node.logs import Logs
    from mavstack.node.modes import Modes
    from mavstack.node.params import Params
    from mavstack.node.shell import Shell
    from mavstack.node.terrain import Terrain
    from mavstack.services import Address
    from mavstack.services.events import DecodedEvent
    from mavstack.services.heartbeat import ComponentInfo, Conflict
    from mavstack.services.version import AutopilotVersion
    from mavstack.vehicle.telemetry import values
    from mavstack.vehicle.telemetry.surroundings import Distance, Obstacles

AnyMessage = TypeVar("AnyMessage", bound=Message)


class Vehicle(ReadOnly):
    """One vehicle; made by `Connection.wait_for_vehicle` and found in `Connection.vehicles`.

    Altitudes are in metres above home, angles in degrees. An action waits until it is complete, unless
    `wait=False`. Every action may raise these errors, which the calls do not list again:

    - `ActionUnsupported`: The vehicle type or the firmware does not support it; nothing was sent.
    - `ActionRefused`: A precondition is not met, such as an armed vehicle; nothing was sent.
    - `CommandDenied`: The vehicle refused; it is as it was before, and the text holds its status texts.
    - `CommandTimeout`: The vehicle did not answer.
    - `ModeTimeout`: The vehicle accepted a mode and did not enter it.
    - `ActionTimeout`: It was not complete within `timeout`, or its progress stalled.
    - `ActionInterrupted`: The vehicle changed its mode or was disarmed meanwhile.
    - `ContactLost`: No heartbeat of the vehicle arrives.
    - `RemoteCancelled`: The connection was closed.
    - `SystemIdConflictError`: Several vehicles use its system id, and none was chosen.
    """

    connection: Node
    component: RemoteComponent
    telemetry: Telemetry

    # Parts of the vehicle

    mission = Part(Mission, "The mission.")
    fence = Part(VehiclePlan, "The geofence.", lambda vehicle: VehiclePlan(vehicle, PlanType.FENCE))
    rally = Part(VehiclePlan, "The rally points.", lambda vehicle: VehiclePlan(vehicle, PlanType.RALLY))
    actuators = Part(Actuators, "The outputs: servos, relays, actuators, motor tests, gripper and winch.")
    calibration = Part(Calibration, "The calibrations of the sensors, the radio control and the motors.")
    roi = Part(
        RegionOfInterest, "The region of interest: the point that the gimbal or the nose keeps pointing at."
    )

    external = Part(External, "The data of a companion computer: estimates, obstacles, targets.")
    devices = Part(Devices, "Motor controllers, generator, engine and modems that report about themselves.")
    rtk = Part(Rtk, "The corrections of its satellite navigation, from a caster or a base.")
    transponder = Part(Transponder, "Its ADS-B transponder, as ArduPilot controls one.")

    def __init__(self, connection: Node, component: RemoteComponent) -> None:
        #: The connection through which the vehicle is reached.
        self.connection = connection
        #: The vehicle's autopilot, with every MAVLink service.
        self.component = component
        #: The received messages, which the properties read.
        self.telemetry = Telemetry(connection, component)
        self._attached: dict[int, Camera] = {}

    # Parts of the autopilot

    @property
    def modes(self) -> Modes:
        """The flight modes."""
        return self.component.modes

    @property
    def params(self) -> Params:
        """The parameters."""
        return self.component.params

    @property
    def ftp(self) -> Ftp:
        """The files on the vehicle (MAVLink FTP); raises `ActionUnsupported` if its firmware has none."""
        firmware_of(self).check_supported("ftp")
        return self.component.ftp

    @property
    def logs(self) -> Logs:
        """The logs on the vehicle; raises `ActionUnsupported` if its firmware has none."""
        firmware_of(self).check_supported("logs")
        return self.component.logs

    @property
    def log_stream(self) -> LogStreams:
        """The log of the vehicle while it is written, as PX4 streams it."""
        return self.component.log_stream

    @property
    def failure(self) -> Failure:
        """Failures that the vehicle simulates on purpose; PX4 does while SYS_FAILURE_EN is 1."""
        return self.component.failure

    @property
    def terrain(self) -> Terrain:
        """The terrain that the vehicle has from ground stations; `serve_terrain` of a node sends it.

        Raises `ActionUnsupported` if its firmware uses none.
        """
        firmware_of(self).check_supported("terrain")
        return self.component.terrain

    # Identity

    @property
    def address(self) -> Address:
        """The address of the autopilot: system id and component id."""
        return self.component.address

    @property
    def system(self) -> int:
        """The system id."""
        return self.address.system

    @property
    def alive(self) -> bool:
        """True if heartbeats of the autopilot arrive."""
        info = self.component.info
        return info is not None and info.alive

    @property
    def components(self) -> Mapping[int, ComponentInfo]:
        """The other components of the system by component id, such as cameras and gimbals."""
        infos = self.connection.components.values()
        own = (info for info in infos if info.address.system == self.system and info.address != self.address)
        return {info.address.component: info for info in own}

    @property
    def info(self) -> ComponentInfo | None:
        """The autopilot's last heartbeat: type, firmware, mode; `version` is that of its software."""
        return self.component.info

    @property
    def has_id_conflict(self) -> bool:
        """True if another vehicle uses the same system id; see `SystemIdConflict`."""
        return self.connection.has_address_conflict(self.address)

    @property
    def id_conflict(self) -> Conflict | None:
        """The vehicles that use the same system id, and what tells them apart; None: only this one does."""
        return self.connection.id_conflict(self.system)

    @property
    def chosen_sender(self) -> str | None:
        """The name of the channel that `choose_sender` chose; None: none was chosen."""
        return self.connection.chosen_sender(self.system)

    def choose_sender(self, channel: Channel | str | None) -> None:
        """Choose the vehicle to work with, where several use this system id.

        Its packets count only on that channel, and packets for it go over that channel alone, until another
        choice or until the channel closes. Values that were received before are forgotten.

        Args:
            channel: The channel, its name, or its remote address, such as "192.168.1.20:14550"; None: take
                the choice back.

        Raises:
            InvalidArgumentError: No open channel is named so, or the vehicles share the channel.
        """
        before = self.chosen_sender
        self.connection.choose_sender(self.system, channel)
        if self.chosen_sender != before:
            self.telemetry.forget()

    @property
    def autopilot(self) -> int:
        """The MAV_AUTOPILOT of the heartbeat."""
        info = self.component.info
        return common.MavAutopilot.GENERIC if info is None else info.autopilot

    @property
    def identifier(self) -> str:
        """The identifier of a firmware that speaks MSP, "BTFL" or "INAV"; empty for all others."""
        info = self.component.info
        return "" if info is None else info.identifier

    @property
    def vehicle_type(self) -> VehicleType:
        """The way the vehicle moves; `mav_type` is the MAV_TYPE of its heartbeat."""
        info = self.component.info
        found = VehicleType.OTHER if info is None else VehicleType.of(info.type)
        # A quadplane may report the type of a plane; EXTENDED_SYS_STATE or a parameter then shows that it is
        # a VTOL.
        if found is VehicleType.PLANE and (self.vtol_state or self._is_enabled_quadplane):
            return VehicleType.VTOL
        return found

    @property
    def _is_enabled_quadplane(self) -> bool:
        enabled = self.params.cached.get(QUADPLANE_PARAMETER)
        return enabled is not None and enabled.value > 0

    @property
    def version(self) -> AutopilotVersion | None:
        """The software and hardware versions; None before `get_version` (AUTOPILOT_VERSION)."""
        return self.telemetry.version

    @property
    def firmware(self) -> Firmware:
        """The firmware's way to take commands, by the MAV_AUTOPILOT of the heartbeat."""
        return firmware_of(self)

    @property
    def capabilities(self) -> Capabilities:
        """The capabilities as far as they are known now; `get_version` requests AUTOPILOT_VERSION."""
        return capabilities_of(self)

    @property
    def health(self) -> Health:
        """The readiness to arm, and the problems and warnings that the vehicle reports."""
        return health_of(self, self.telemetry)

    # Actions

    wait_until_ready = readiness.wait_until_ready
    arm = arming.arm
    disarm = arming.disarm
    takeoff = takeoff.takeoff
    land = landing.land
    rtl = landing.rtl
    hold = flying.hold
    goto = flying.goto
    move = flying.move
    orbit = flying.orbit
    set_speed = flying.set_speed
    set_yaw = flying.set_yaw
    transition_to_fixed_wing = transition.transition_to_fixed_wing
    transition_to_multicopter = transition.transition_to_multicopter
    terminate = arming.terminate
    reboot = arming.reboot
    set_home = home.set_home
    renumber = renumber.renumber

    set_mode = commands.set_mode
    command = commands.command
    get_version = commands.get_version
    set_ekf_source = commands.set_ekf_source
    guided = guided_session.guided
    follow = following.follow

    # Positions; a call requests a position that is not known, or waits for it

    get_home = positions.get_home
    get_home_altitude = positions.get_home_altitude
    get_position = positions.get_position
    get_relative_altitude = positions.get_relative_altitude

    # Cameras and gimbals

    @property
    def cameras(self) -> tuple[Camera, ...]:
        """The cameras that are known: by their heartbeats, and the attached ones after `find_cameras`."""
        return (*payloads.alive_cameras(self), *self._attached.values())

    camera = payloads.camera
    wait_for_camera = payloads.wait_for_camera

    async def find_cameras(self, *, timeout: float | None = None) -> tuple[Camera, ...]:
        """Ask the autopilot for attached cameras (CAMERA_INFORMATION), and return all that are known.

        Args:
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Returns:
            The cameras; `cameras` holds the same from then on.

        Raises:
            MessageTimeout: The autopilot does not answer.
        """
        for camera in await self.component.list_cameras(timeout=timeout):
            if camera.device_id:
                self._attached[camera.device_id] = camera
        return self.cameras

    @property
    def gimbal(self) -> Gimbal:
        """All gimbals that the autopilot manages, as one; `find_gimbals` returns each of them."""
        return self.component.gimbal

    find_gimbals = payloads.find_gimbals

    # Messages

    def latest(self, message: type[AnyMessage], component: int | None = None) -> AnyMessage | None:
        """Return the last message of a class.

        Args:
            message: The message class, such as `common.Attitude`.
            component: The component id of the sender; None is the autopilot.

        Returns:
            The message, or None if none was received.
        """
        return self.telemetry.latest(message, component)

    def age(self, message: type[Message], component: int | None = None) -> float | None:
        """Return the seconds since the last message of a class was received.

        Args:
            message: The message class.
            component: The component id of the sender; None is the autopilot.

        Returns:
            Seconds, or None if no message was received.
        """
        return self.telemetry.age(message, component)

    stream = messages.stream
    wait_for_message = messages.wait_for_message
    add_listener = messages.add_listener
    set_message_rate = messages.set_message_rate

    def events(
        self, *, severity: int = LogLevel.DEBUG, component: int | None = None, queue: int = DEFAULT_QUEUE
    ) -> EventStream:
        """Subscribe to the vehicle's events (EVENT): notices that arrive in order and each once.

        PX4 has them for arming, refusals, modes, failsafes and checks; ArduPilot has none. Missing events are
        requested again. Their words are in the vehicle's metadata, which is downloaded once.

        Args:
            severity: The least severe level to deliver, a MAV_SEVERITY or `LogLevel`; `LogLevel.DISABLED`:
                every event, also those that are for programs only.
            component: The component id of the sender; None: the autopilot.
            queue: Events that are queued while the program does not read; then the oldest is dropped.

        Returns:
            An async iterator of the events: severity, name, message with its arguments, arguments by name.

        Raises:
            InvalidTypeError: The severity is not a number.
            InvalidArgumentError: The severity is not from 0 to 9.
        """
        return self._component(component).events(severity=severity, queue=queue)

    def add_event_listener(
        self,
        callback: Callable[[DecodedEvent], object],
        *,
        severity: int = LogLevel.DEBUG,
        component: int | None = None,
    ) -> EventListener:
        """Call a function with each event of the vehicle (EVENT); see `events`.

        Args:
            callback: The function. It must return quickly, since it runs in the event loop.
            severity: The least severe level to deliver, as for `events`.
            component: The component id of the sender; None: the autopilot.

        Returns:
            The listener; its `close()` ends the calls.

        Raises:
            InvalidTypeError: The severity is not a number.
            InvalidArgumentError: The severity is not from 0 to 9.
        """
        return self._component(component).add_event_listener(callback, severity=severity)

    def _component(self, component: int | None) -> RemoteComponent:
        return self.component if component is None else self.connection.component(self.system, component)

    def shell(self) -> Shell:
        """Return a context manager during which the firmware's shell is open (SERIAL_CONTROL).

        Returns:
            The shell.

        Raises:
            ActionUnsupported: The firmware has none.
        """
        firmware_of(self).check_supported("shell")
        return self.component.shell()

    # Values: each property returns the last value received, None before the first, and sends nothing

    @property
    def position(self) -> values.Position | None:
        """The global position, in degrees and metres (GLOBAL_POSITION_INT)."""
        return readers.read_position(self.telemetry)

    @property
    def local_position(self) -> values.LocalPosition | None:
        """The position in the local frame, in metres (LOCAL_POSITION_NED)."""
        return readers.read_local_position(self.telemetry)

    @property
    def velocity(self) -> values.Velocity | None:
        """The velocity over ground, in m/s (LOCAL_POSITION_NED or GLOBAL_POSITION_INT)."""
        return readers.read_velocity(self.telemetry)

    @property
    def attitude(self) -> values.Attitude | None:
        """The attitude, in degrees and degrees per second (ATTITUDE or ATTITUDE_QUATERNION)."""
        return readers.read_attitude(self.telemetry)

    @property
    def heading(self) -> float | None:
        """The direction in which the vehicle points, 0 to 360 degrees (GLOBAL_POSITION_INT or ATTITUDE)."""
        position, attitude = self.position, self.attitude
        if position is not None and position.heading is not None:
            return position.heading
        return None if attitude is None else attitude.heading

    @property
    def ground_speed(self) -> float | None:
        """The horizontal speed over ground, in m/s (LOCAL_POSITION_NED, GLOBAL_POSITION_INT or VFR_HUD)."""
        velocity, hud = self.velocity, self.vfr_hud
        if velocity is not None:
            return velocity.ground_speed
        return None if hud is None else hud.ground_speed

    @property
    def climb_rate(self) -> float | None:
        """The vertical speed, in m/s, positive up (LOCAL_POSITION_NED, GLOBAL_POSITION_INT or VFR_HUD)."""
        velocity, hud = self.velocity, self.vfr_hud
        if velocity is not None:
            return -velocity.down
        return None if hud is None else hud.climb

    @property
    def vfr_hud(self) -> values.VfrHud | None:
        """Airspeed, ground speed and climb rate in m/s, and throttle in percent (VFR_HUD)."""
        return readers.read_vfr_hud(self.telemetry)

    @property
    def home(self) -> values.HomePosition | None:
        """The home position, in degrees and metres above mean sea level (HOME_POSITION)."""
        return readers.read_home(self.telemetry)

    @property
    def wind(self) -> values.Wind | None:
        """The estimated wind, in m/s (WIND_COV or WIND)."""
        return readers.read_wind(self.telemetry)

    @property
    def odometry(self) -> values.Odometry | None:
        """The odometry estimate, in metres, m/s and degrees per second (ODOMETRY)."""
        return readers.read_odometry(self.telemetry)

    @property
    def distances(self) -> Mapping[int, Distance]:
        """The measurements of its rangefinders by id, in metres (DISTANCE_SENSOR)."""
        return readers.read_distances(self.telemetry)

    @property
    def obstacles(self) -> Obstacles | None:
        """The obstacles around it, in metres and degrees (OBSTACLE_DISTANCE)."""
        return readers.read_obstacles(self.telemetry)

    @property
    def gps(self) -> values.Gps | None:
        """The state of the satellite navigation receiver, in degrees, metres and m/s (GPS_RAW_INT)."""
        return readers.read_gps(self.telemetry)

    @property
    def imu(self) -> values.Imu | None:
        """The inertial sensors, in m/s², degrees per second and gauss (HIGHRES_IMU or SCALED_IMU)."""
        return readers.read_imu(self.telemetry)

    @property
    def rc(self) -> values.Rc | None:
        """The radio control input, in microseconds per channel (RC_CHANNELS or RC_CHANNELS_RAW)."""
        return readers.read_rc(self.telemetry)

    rc_pulse = messages.rc_pulse

    @property
    def battery(self) -> values.Battery | None:
        """The first battery, in volts, amperes and percent (BATTERY_STATUS or SYS_STATUS)."""
        return next(iter(readers.read_batteries(self.telemetry).values()), None)

    @property
    def batteries(self) -> Mapping[int, values.Battery]:
        """All batteries by id, in volts, amperes and percent (BATTERY_STATUS or SYS_STATUS)."""
        return readers.read_batteries(self.telemetry)

    @property
    def armed(self) -> bool | None:
        """True if the motors may run (HEARTBEAT)."""
        return readers.read_armed(self.telemetry)

    @property
    def mode(self) -> str | None:
        """The name of the flight mode (HEARTBEAT or CURRENT_MODE)."""
        return readers.read_mode(self.telemetry)

    @property
    def in_air(self) -> bool | None:
        """True if the vehicle flies (EXTENDED_SYS_STATE, HEARTBEAT, or its height with speed or throttle)."""
        return readers.read_in_air(self.telemetry)

    @property
    def landed_state(self) -> common.MavLandedState | int | None:
        """The MAV_LANDED_STATE: on the ground, taking off, in the air or landing (EXTENDED_SYS_STATE)."""
        return readers.read_landed_state(self.telemetry)

    @property
    def vtol_state(self) -> common.MavVtolState | int | None:
        """The MAV_VTOL_STATE: hovering or flying forward; None if it is no VTOL (EXTENDED_SYS_STATE)."""
        return readers.read_vtol_state(self.telemetry)

    @property
    def system_status(self) -> common.MavState | int | None:
        """The MAV_STATE of the autopilot (HEARTBEAT)."""
        return readers.read_system_status(self.telemetry)

    @property
    def mav_type(self) -> common.MavType | int | None:
        """The MAV_TYPE of the vehicle (HEARTBEAT)."""
        info = self.telemetry.component.info
        return None if info is None else info.type

    @property
    def status_texts(self) -> list[values.StatusText]:
        """The last status texts of the vehicle's system, oldest first (STATUSTEXT)."""
        return self.telemetry.status_texts.all()

    wait_for_telemetry = value_streams.wait_for_telemetry
    stream_position = value_streams.stream_position
    stream_local_position = value_streams.stream_local_position
    stream_velocity = value_streams.stream_velocity
    stream_attitude = value_streams.stream_attitude
    stream_vfr_hud = value_streams.stream_vfr_hud
    stream_home = value_streams.stream_home
    stream_wind = value_streams.stream_wind
    stream_odometry = value_streams.stream_odometry
    stream_gps = value_streams.stream_gps
    stream_imu = value_streams.stream_imu
    stream_rc = value_streams.stream_rc
    stream_battery = value_streams.stream_battery
    stream_armed = value_streams.stream_armed
    stream_mode = value_streams.stream_mode
    stream_in_air = value_streams.stream_in_air
    stream_landed_state = value_streams.stream_landed_state

    def __repr__(self) -> str:
        return f"<Vehicle {self.address}>"

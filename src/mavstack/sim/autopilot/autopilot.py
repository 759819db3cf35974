"""The autopilot of one simulated vehicle: modes, arming, home and the tick.

The autopilot ticks ten times a second: first the watches (radio, ground link, battery, fence), each of which
may change the mode, then the behaviour of the mode. The firmware profile holds the differences of a firmware.
"""

from __future__ import annotations

from math import degrees, inf, sqrt
from types import GeneratorType
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.services.mission import MissionItem
from mavstack.sim.autopilot.fence import FenceWatch
from mavstack.sim.autopilot.guided import GuidedFlight
from mavstack.sim.autopilot.maneuvers import maneuvers_of
from mavstack.sim.autopilot.mission import MissionRunner
from mavstack.sim.autopilot.payload import Payload
from mavstack.sim.autopilot.radio import RadioControl
from mavstack.sim.autopilot.rally import RallyPoints
from mavstack.sim.autopilot.tasks import Tasks
from mavstack.sim.vehicle_types import Home

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from mavstack.services import Address
    from mavstack.services.modes import AvailableMode
    from mavstack.sim.autopilot.behaviour import Behaviour
    from mavstack.sim.autopilot.external_vision import ExternalVision
    from mavstack.sim.autopilot.firmware_profile import FirmwareProfile, Mode
    from mavstack.sim.autopilot.landing_target import LandingAim, LandingTarget
    from mavstack.sim.autopilot.obstacle_input import ObstacleInput
    from mavstack.sim.autopilot.ticks import Watch
    from mavstack.sim.vehicle import SimulatedVehicle

#: Time from power-on until the sensors are settled and the position is known, in seconds.
BOOT_TIME = 2.0
#: Speed in m/s below which a vehicle on the ground is at rest.
_AT_REST = 0.3
#: Time at rest until the vehicle counts as landed, in seconds.
_LANDED_AFTER = 0.5

#: These flags are plain integers, because integers are faster to combine on each tick than enum members.
_CUSTOM, _ARMED = int(common.MavModeFlag.CUSTOM_MODE_ENABLED), int(common.MavModeFlag.SAFETY_ARMED)
_LANDED = common.MavLandedState


class SimulatedAutopilot:
    """An autopilot: its state, its mode, and the parts that fly one vehicle."""

    def __init__(self, vehicle: SimulatedVehicle, profile: FirmwareProfile) -> None:
        self.vehicle = vehicle
        self.body = vehicle.body
        self.profile = profile
        self.flight_parameters = profile.flight_parameters(vehicle)
        self.maneuvers = maneuvers_of(self)
        self.guided = GuidedFlight(self)
        self.radio = RadioControl(
            vehicle,
            transmitter=profile.transmitter,
            may_steer=lambda source: profile.may_steer(vehicle, source),
        )
        self.now = self.booted_at = vehicle.now
        self.armed = False
        self.armed_at = self.disarmed_at = -inf
        self.home: Home | None = None
        #: True if home was set by a command, so that arming does not move it.
        self.home_locked = False
        #: The point that the vehicle flies to or circles, in local metres (north, east, down); read by the
        #: telemetry.
        self.target: tuple[float, float, float] | None = None
        self.payload = Payload(self)
        self.tasks = Tasks(vehicle)
        self.watches: list[Watch] = [self.tasks, self.payload]
        self.mission, self.fence, self.rally = MissionRunner(self), FenceWatch(self), RallyPoints(self)
        #: Names of the active failsafes; any of them makes the vehicle's state critical.
        self.failsafes: set[str] = set()
        self.terminated = False
        self.disarm_reason = ""
        self._modes: dict[int, Mode] = {mode.number: mode for mode in profile.modes}
        self.mode: Mode = self._modes[profile.initial]
        self.mode_reason = "initialised"
        self._behaviour: Behaviour | None = None
        self._script: Iterator[None] | None = None
        self._at_rest_since: float | None = vehicle.now
        self.landed = True
        #: True if there was a position fix since the boot.
        self._located = False
        #: Receives position estimates of a companion computer; None if the parameters disable external
        #: estimates.
        self.vision: ExternalVision | None = None
        #: Receives obstacles that a companion computer reports; None if the firmware does not accept them.
        self.obstacle_input: ObstacleInput | None = None
        #: Receives the landing target that a companion computer reports; None if the firmware has no mode for
        #: it.
        self.landing_target: LandingTarget | None = None
        #: Returns the place onto which a landing vehicle descends; None to descend at the present place.
        self.landing_aim: Callable[[], LandingAim | None] = lambda: None
        #: Returns the landing on a target for a precision as in param2 of NAV_LAND, None for the precision of
        #: the return; None: the vehicle just lands.
        self.precise_landing: Callable[[int | None], Behaviour | None] = lambda precision: None
        #: True if a client set the origin of the local frame.
        self.has_origin = False

    # State

    @property
    def behaviour(self) -> Behaviour | None:
        """The behaviour of the current mode; None while disarmed."""
        return self._behaviour

    @property
    def booted(self) -> bool:
        """True when start-up is complete."""
        return self.now - self.booted_at >= BOOT_TIME

    @property
    def landed_state(self) -> int:
        """MAV_LANDED_STATE."""
        behaviour = self._behaviour
        if self.landed or not self.vehicle.vehicle_type.flies:
            return _LANDED.ON_GROUND
        if behaviour is not None and behaviour.taking_off:
            return _LANDED.TAKEOFF
        return _LANDED.LANDING if behaviour is not None and behaviour.landing else _LANDED.IN_AIR

    @property
    def system_status(self) -> int:
        """MAV_STATE."""
        if self.terminated:
            return common.MavState.FLIGHT_TERMINATION
        if not self.armed:
            return self.profile.resting_state(self)
        return common.MavState.CRITICAL if self.failsafes else self.profile.armed_state(self)

    @property
    def base_mode(self) -> int:
        """The flags of HEARTBEAT's `base_mode`."""
        flags = int(self.mode.flags) | _CUSTOM
        return flags | _ARMED if self.profile.reports_armed(self) else flags

    @property
    def has_position(self) -> bool:
        """True while the position estimate is good."""
        return self._located and self.booted and self.body.health.horizontal

    # Periodic update

    def tick(self, now: float) -> None:
        """Run the watches and the behaviour once, at the time `now`."""
        self.now = now
        self._check_ground(now)
        self._located = self._located or self._is_located()
        if self.home is None and self.has_position:
            self.set_home_here()
        for watch in tuple(self.watches):
            watch.tick(now)
        self._fly()
        self._disarm_after_landing(now)

    def _is_located(self) -> bool:
        """Return whether the place on Earth is known: by GPS, or by estimates and an origin."""
        if self.vision is not None and self.vision.aids_position and self.has_origin:
            return True
        return self.body.sensors.gps_fix >= common.GpsFixType["_3D_FIX"]

    def _check_ground(self, now: float) -> None:
        body, truth = self.body, self.body.truth
        speed = sqrt(truth.velocity_north**2 + truth.velocity_east**2 + truth.velocity_down**2)
        resting = body.on_ground and speed < _AT_REST
        if not resting:
            self._at_rest_since = None
            self.landed = self.landed and body.on_ground
        elif self._at_rest_since is None:
            self._at_rest_since = now
        elif now - self._at_rest_since >= _LANDED_AFTER:
            self.landed = True

    def _fly(self) -> None:
        mode, script = self.mode, self._script
        if script is None or self.terminated:
            return
        if next(script, _ENDED) is _ENDED and self._script is script:
            self._script = None
            if mode.then is not None and self.armed:
                self.enter(mode.then, "its end was reached")

    def _disarm_after_landing(self, now: float) -> None:
        behaviour = self._behaviour
        flies = self.vehicle.vehicle_type.flies and (behaviour is None or not behaviour.taking_off)
        if self.armed and flies and self.landed and self._at_rest_since is not None:
            since = max(self._at_rest_since, self.armed_at)
            landing = behaviour is not None and behaviour.landing
            delay = (
                self.flight_parameters.land_disarm_delay if landing else self.flight_parameters.disarm_delay
            )
            if now - since >= delay:
                self.disarm("landed")

    # Modes

    def find_mode(self, number: int) -> Mode | None:
        """Return the mode of a `custom_mode`; None if the firmware has none of that number."""
        return self._modes.get(number)

    def may_enter(self, available: AvailableMode, source: Address) -> str | None:
        """Return why the mode service may not enter a mode now; None if it may."""
        return self.profile.mode_refusal(self, self._modes[available.custom_mode])

    def entered(self, number: int, source: Address | None) -> None:
        """Begin a mode that was changed through the mode service."""
        self._begin(self._modes[number], "commanded" if source else self.mode_reason)

    def enter(self, number: int, reason: str, *, commanded: bool = False) -> bool:
        """Enter a mode, for a command or a failsafe.

        Args:
            number: The mode's `custom_mode`.
            reason: The reason of the change, for the log.
            commanded: True if a command asked for the mode.

        Returns:
            False if the mode cannot be entered.
        """
        mode = self._modes[number]
        if mode.needs_position and not self.has_position and self.armed:
            return False
        self.mode_reason = reason
        self.vehicle.modes.enter(number, self.now, commanded=commanded)
        self.vehicle.touch(self.vehicle.modes)
        self._begin(mode, reason)
        return True

    def restart_behaviour(self) -> None:
        """Restart the behaviour of the current mode, as after arming."""
        self._begin(self.mode, self.mode_reason)

    def _begin(self, mode: Mode, reason: str) -> None:
        self.end_behaviour()
        before, self.mode, self.mode_reason = self.mode, mode, reason
        self.maneuvers.reset_choices()
        if mode is not before:
            self.vehicle.mode_entered(mode, reason)
        if self.armed and not self.terminated:
            self._behaviour = mode.behaviour(self)
            self._script = self._behaviour.fly()

    def end_behaviour(self) -> None:
        """Stop the current behaviour."""
        script, self._script, self._behaviour = self._script, None, None
        self.target = None
        if (
            isinstance(script, GeneratorType) and not script.gi_running
        ):  # a running generator cannot be closed, as when the script itself ends the behaviour
            script.close()

    # Arming

    def arm(self, *, force: bool = False) -> list[str]:
        """Arm.

        Args:
            force: Skip the arming checks.

        Returns:
            The reasons for a refusal; an empty list if the vehicle is armed now.
        """
        if self.armed:
            return []
        problems = [] if force else list(self.profile.arming_problems(self))
        if not problems:
            self.armed, self.armed_at = True, self.now
            if self.has_position and not self.home_locked:
                self.set_home_here()
            self.body.idle()
            self.vehicle.armed_changed()
            self.profile.armed(self)
            self.restart_behaviour()
        return problems

    def disarm(self, reason: str) -> None:
        """Stop the motors, wherever the vehicle is."""
        if not self.armed:
            return
        self.end_behaviour()
        self.armed, self.disarmed_at, self.disarm_reason = False, self.now, reason
        self.body.stop()
        self.vehicle.armed_changed()
        self.profile.disarmed(self)

    def terminate(self) -> None:
        """Terminate the flight: stop the motors permanently."""
        self.terminated = True
        self.disarm("terminated")

    # Home

    def set_home_here(self) -> None:
        """Set home to the current position."""
        here = self.body.estimate
        self.set_home(*self.body.frame.to_global(here.north, here.east, here.down), yaw=here.yaw)

    def set_home(self, latitude: float, longitude: float, altitude: float, *, yaw: float = 0.0) -> None:
        """Set home: degrees, metres above mean sea level, radians."""
        self.home = Home(latitude, longitude, altitude, degrees(yaw))
        self.vehicle.mission.home = MissionItem(
            common.MavCmd.NAV_WAYPOINT,
            param5=latitude,
            param6=longitude,
            param7=altitude,
            frame=common.MavFrame.GLOBAL,
        )
        self.vehicle.home_changed()

    @property
    def home_position(self) -> tuple[float, float, float]:
        """Home in local metres; the place of the start while there is no home."""
        if self.home is None:
            return 0.0, 0.0, 0.0
        return self.body.frame.to_local(self.home.latitude, self.home.longitude, self.home.altitude)

    @property
    def altitude(self) -> float:
        """Altitude above home, in metres."""
        return self.home_position[2] - self.body.estimate.down


_ENDED = object()

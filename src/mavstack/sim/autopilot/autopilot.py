"""The autopilot of one simulated vehicle: its mode, whether it is armed, where home is, and what it does.

Ten times a second it looks at the vehicle (`tick`): watches first (radio, ground link, battery, fence), each
of which may change the mode, then the behaviour of the mode. What differs between firmwares is the profile's.
"""

from __future__ import annotations

from math import degrees, inf, sqrt
from types import GeneratorType
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.services.mission import MissionItem
from mavstack.sim.autopilot.commands.tasks import Tasks
from mavstack.sim.autopilot.fence import FenceWatch
from mavstack.sim.autopilot.guided import GuidedTarget
from mavstack.sim.autopilot.maneuvers import maneuvers_of
from mavstack.sim.autopilot.mission import MissionRunner
from mavstack.sim.autopilot.payload import Payload
from mavstack.sim.autopilot.radio import RadioControl
from mavstack.sim.autopilot.rally import RallyPoints
from mavstack.sim.vehicle_types import Home

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.services import Address
    from mavstack.services.modes import AvailableMode
    from mavstack.sim.autopilot.control import RunningBehaviour
    from mavstack.sim.autopilot.interfaces import FirmwareProfile, Mode, Vehicle
    from mavstack.sim.autopilot.state import Watch

#: From power to readiness: sensors settle and the first position is found.
BOOT_TIME = 2.0
#: Slower than this in all directions on the ground is at rest.
_AT_REST = 0.3
#: For so long the vehicle is at rest before it counts as landed.
_LANDED_AFTER = 0.5

#: As plain numbers: they are put together on each tick.
_CUSTOM, _ARMED = int(common.MavModeFlag.CUSTOM_MODE_ENABLED), int(common.MavModeFlag.SAFETY_ARMED)
_LANDED = common.MavLandedState


class SimulatedAutopilot:
    """Flies one vehicle."""

    def __init__(self, vehicle: Vehicle, profile: FirmwareProfile) -> None:
        self.vehicle = vehicle
        self.body = vehicle.body
        self.profile = profile
        self.flight_parameters = profile.flight_parameters(vehicle)
        self.maneuvers = maneuvers_of(self)
        self.guided = GuidedTarget(self)
        self.radio = RadioControl(
            vehicle,
            transmitter=profile.transmitter,
            may_steer=lambda source: profile.may_steer(vehicle, source),
        )
        self.now = self.booted_at = vehicle.now
        self.armed = False
        self.armed_at = self.disarmed_at = -inf
        self.home: Home | None = None
        #: Whether somebody said where home is, so that arming does not move it.
        self.home_locked = False
        #: Where the vehicle is on its way to or what it circles, in local metres; for telemetry.
        self.target: tuple[float, float, float] | None = None
        self.payload = Payload(self)
        self.tasks = Tasks(vehicle)
        self.watches: list[Watch] = [self.tasks, self.payload]
        self.mission, self.fence, self.rally = MissionRunner(self), FenceWatch(self), RallyPoints(self)
        #: What the watches found, by name; any of these makes the vehicle's state critical.
        self.failsafes: set[str] = set()
        self.terminated = False
        self.disarm_reason = ""
        self._modes: dict[int, Mode] = {mode.number: mode for mode in profile.modes}
        self.mode: Mode = self._modes[profile.initial]
        self.mode_reason = "initialised"
        self._behaviour: RunningBehaviour | None = None
        self._script: Iterator[None] | None = None
        self._at_rest_since: float | None = vehicle.now
        self.landed = True
        #: Whether there was a fix since the boot.
        self._located = False

    # What it is doing

    @property
    def behaviour(self) -> RunningBehaviour | None:
        """What the mode does now; None while disarmed."""
        return self._behaviour

    @property
    def booted(self) -> bool:
        """Whether it is ready to look at the world."""
        return self.now - self.booted_at >= BOOT_TIME

    @property
    def landed_state(self) -> int:
        """MAV_LANDED_STATE."""
        behaviour = self._behaviour
        if self.landed or not self.vehicle.type.flies:
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
        return common.MavState.CRITICAL if self.failsafes else common.MavState.ACTIVE

    @property
    def base_mode(self) -> int:
        """HEARTBEAT's flags."""
        flags = int(self.mode.flags) | _CUSTOM
        return flags | _ARMED if self.armed else flags

    @property
    def has_position(self) -> bool:
        """Whether it knows where it is."""
        return self._located and self.booted and self.body.health.horizontal

    # Time

    def tick(self, now: float) -> None:
        """Look at the vehicle and act."""
        self.now = now
        self._look_at_ground(now)
        self._located = self._located or self.body.sensors.gps_fix >= common.GpsFixType["_3D_FIX"]
        if self.home is None and self.has_position:
            self.set_home_here()
        for watch in tuple(self.watches):
            watch.tick(now)
        self._fly()
        self._disarm_after_landing(now)

    def _look_at_ground(self, now: float) -> None:
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
        flies = self.vehicle.type.flies and (behaviour is None or not behaviour.taking_off)
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
        """The mode of a `custom_mode`."""
        return self._modes.get(number)

    def may_enter(self, available: AvailableMode, source: Address) -> str | None:
        """Why a mode may not be entered now; for the service that is asked for it."""
        return self.profile.mode_refusal(self, self._modes[available.custom_mode])

    def entered(self, number: int, source: Address | None) -> None:
        """Somebody changed the mode through the service."""
        self._begin(self._modes[number], "commanded" if source else self.mode_reason)

    def enter(self, number: int, reason: str, *, commanded: bool = False) -> bool:
        """Enter a mode of the autopilot's own accord, or as part of a command; False if it cannot be."""
        mode = self._modes[number]
        if mode.needs_position and not self.has_position and self.armed:
            return False
        self.mode_reason = reason
        self.vehicle.modes.enter(number, self.now, commanded=commanded)
        self.vehicle.touch(self.vehicle.modes)
        self._begin(mode, reason)
        return True

    def restart_behaviour(self) -> None:
        """Begin what the mode does anew, as after arming."""
        self._begin(self.mode, self.mode_reason)

    def _begin(self, mode: Mode, reason: str) -> None:
        self.end_behaviour()
        before, self.mode, self.mode_reason = self.mode, mode, reason
        self.maneuvers.forget_choices()
        if mode is not before:
            self.vehicle.mode_entered(mode, reason)
        if self.armed and not self.terminated:
            self._behaviour = mode.behaviour(self)
            self._script = self._behaviour.fly()

    def end_behaviour(self) -> None:
        """Stop doing what the mode does."""
        script, self._script, self._behaviour = self._script, None, None
        self.target = None
        if isinstance(script, GeneratorType) and not script.gi_running:  # it may itself be what ends it
            script.close()

    # Arming

    def arm(self, *, force: bool = False) -> list[str]:
        """Arm; gives the reasons why not, none if it is armed now."""
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
        """End the flight: motors off, for good."""
        self.terminated = True
        self.disarm("terminated")

    # Home

    def set_home_here(self) -> None:
        """Make the place where the vehicle is its home."""
        here = self.body.estimate
        self.set_home(*self.body.frame.to_global(here.north, here.east, here.down), yaw=here.yaw)

    def set_home(self, latitude: float, longitude: float, altitude: float, *, yaw: float = 0.0) -> None:
        """Make a place home; altitude above mean sea level."""
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
        """Home in local metres; where the vehicle began if there is none yet."""
        if self.home is None:
            return 0.0, 0.0, 0.0
        return self.body.frame.to_local(self.home.latitude, self.home.longitude, self.home.altitude)

    @property
    def altitude(self) -> float:
        """Above home, in metres."""
        return self.home_position[2] - self.body.estimate.down


_ENDED = object()

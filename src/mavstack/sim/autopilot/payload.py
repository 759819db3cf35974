"""The payload of a vehicle: servos, relays, gripper, parachute, camera, gimbal.

Commands and missions of both firmwares act on it, and telemetry reads it. Repeated actions (a servo that
cycles, pictures every few seconds or metres) run with the autopilot's ticks.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from math import atan2, copysign, dist, hypot, inf
from typing import TYPE_CHECKING

from mavstack.dialects import common

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot
    from mavstack.sim.autopilot.maneuvers import Point

SERVOS = 16
RELAYS = 6
_NEUTRAL = 1500
_HIGHEST_RATE = 10.0
#: The speed in m/s at which a winch unwinds to a given length.
_WINCH_SPEED = 1.0


@dataclass(slots=True)
class Gimbal:
    """Direction of a gimbal in radians; yaw from the nose, or from north if it is locked."""

    roll: float = 0.0
    pitch: float = 0.0
    yaw: float = 0.0
    yaw_locked: bool = False


@dataclass(slots=True)
class _Repetition:
    """A repeated action."""

    act: Callable[[int], None]
    period: float
    remaining: float
    due: float
    done: int = 0


@dataclass(slots=True)
class _Trigger:
    """Pictures at a distance in metres."""

    distance: float
    last: Point = field(default=(inf, inf, inf))


class Payload:
    """The payload of one vehicle; one of its autopilot's watches."""

    def __init__(self, autopilot: SimulatedAutopilot) -> None:
        self._autopilot = autopilot
        #: Commanded PWM in microseconds, by servo number (from 1).
        self.servos: dict[int, int] = {}
        self.relays: dict[int, bool] = {}
        self.gripper_closed = False
        self.parachute_enabled = False
        self.parachute_released = False
        self.sprayer = False
        #: Length of the unwound line in metres, and the unwinding speed in m/s.
        self.winch, self.winch_speed = 0.0, 0.0
        #: Takes a picture with the vehicle's camera component; None if the vehicle has no camera.
        self.trigger: Callable[[], None] | None = None
        self.images = 0
        self.recording = False
        self.zoom = 0.0
        self.focus = 0.0
        self.gimbal = Gimbal()
        #: The number of the motor under test (0 if none is tested), and its throttle from 0 to 1.
        self.motor_tested, self.motor_throttle = 0, 0.0
        self.motor_tested_until = -inf
        #: The point at which the nose or the gimbal points, in local metres; None if there is none.
        self.region_of_interest: Point | None = None
        self._repetitions: dict[str, _Repetition] = {}
        self._trigger: _Trigger | None = None

    # Outputs

    def set_servo(self, number: int, pwm: int) -> bool:
        """Move a servo; returns False if there is no such servo."""
        if not 1 <= number <= SERVOS:
            return False
        self._repetitions.pop(f"servo {number}", None)
        self.servos[number] = min(max(pwm, 0), 2500)
        return True

    def repeat_servo(self, number: int, pwm: int, count: float, period: float) -> bool:
        """Move a servo between a position and its middle `count` times, with a period in seconds."""
        if not self.set_servo(number, pwm):
            return False

        def move(turn: int) -> None:
            self.servos[number] = pwm if turn % 2 == 0 else _NEUTRAL

        self._repeat(f"servo {number}", move, period / 2, count * 2)
        return True

    def set_relay(self, number: int, *, on: bool) -> bool:
        """Switch a relay; returns False if there is no such relay."""
        if not 0 <= number < RELAYS:
            return False
        self._repetitions.pop(f"relay {number}", None)
        self.relays[number] = on
        return True

    def repeat_relay(self, number: int, count: float, period: float) -> bool:
        """Toggle a relay `count` times, with a period in seconds."""
        if not self.set_relay(number, on=not self.relays.get(number, False)):
            return False

        def switch(turn: int) -> None:
            self.relays[number] = not self.relays[number]

        self._repeat(f"relay {number}", switch, period / 2, count * 2 - 1)
        return True

    def grip(self, *, closed: bool) -> None:
        """Close or open the gripper."""
        self.gripper_closed = closed

    def release_parachute(self) -> bool:
        """Release the parachute and stop the motors; returns False if it is disabled or released already."""
        if not self.parachute_enabled or self.parachute_released:
            return False
        self.parachute_released = True
        self._autopilot.disarm("parachute released")
        return True

    def wind(self, action: int, length: float, rate: float) -> None:
        """Run the winch: relax (0), unwind by `length` metres (1), or unwind at `rate` m/s (2)."""
        self._repetitions.pop("winch", None)
        if action == 1:
            speed = abs(rate) or _WINCH_SPEED
            self._run_winch(copysign(speed, length), max(self.winch + length, 0.0))
        else:
            self._run_winch(rate if action == 2 else 0.0, copysign(inf, rate))

    def _run_winch(self, speed: float, end: float) -> None:
        """Pay out line at a speed until its length is `end`; stop if the speed is 0."""
        self.winch_speed = speed
        period = 1 / _HIGHEST_RATE

        def pull(turn: int) -> None:
            length = max(self.winch + speed * period, 0.0)
            if (end - length) * speed <= 0.0 or (length == 0.0 and speed < 0.0):
                length, self.winch_speed = (
                    max(min(length, end) if speed > 0.0 else max(length, end), 0.0),
                    0.0,
                )
                self._repetitions.pop("winch", None)
            self.winch = length

        if speed:
            self._repeat("winch", pull, period, inf)

    def test_motor(self, number: int, throttle: float, seconds: float) -> None:
        """Run one motor for some seconds, at a throttle in percent."""
        self.motor_tested, self.motor_throttle = number, min(max(throttle, 0.0), 100.0) / 100
        self.motor_tested_until = self._autopilot.now + seconds

    # Camera

    def take_image(self) -> None:
        """Take one picture: by the camera component, or by a simple camera at the autopilot."""
        self.images += 1
        if self.trigger is not None:
            self.trigger()
            return
        vehicle, here = self._autopilot.vehicle, self._autopilot.body.estimate
        latitude, longitude, altitude = self._autopilot.body.frame.to_global(here.north, here.east, here.down)
        vehicle.services.send(
            common.CameraImageCaptured(
                time_boot_ms=vehicle.uptime_ms,
                time_utc=int(vehicle.now * 1e6),
                camera_id=1,
                lat=round(latitude * 1e7),
                lon=round(longitude * 1e7),
                alt=round(altitude * 1e3),
                relative_alt=round(self._autopilot.altitude * 1e3),
                image_index=self.images - 1,
                capture_result=1,
            )
        )

    def take_images(self, period: float, count: float) -> None:
        """Take `count` pictures, one every `period` seconds; an infinite count runs until it is stopped."""
        self.take_image()
        if count > 1:
            self._repeat("camera", lambda _: self.take_image(), period, count - 1)

    def take_images_every(self, distance: float) -> None:
        """Take a picture every `distance` metres; 0 stops it."""
        self._trigger = _Trigger(distance) if distance > 0 else None

    def stop_images(self) -> None:
        """Stop taking pictures."""
        self._repetitions.pop("camera", None)
        self._trigger = None

    @property
    def takes_images(self) -> bool:
        """True while pictures are taken repeatedly."""
        return "camera" in self._repetitions or self._trigger is not None

    def clear_region(self) -> None:
        """Point the gimbal ahead."""
        self.region_of_interest, self.gimbal = None, Gimbal()

    # Periodic update

    def tick(self, now: float) -> None:
        """Run the repeated actions, and point at the region of interest."""
        for name, repetition in tuple(self._repetitions.items()):
            if now >= repetition.due:
                repetition.due = now + repetition.period
                repetition.act(repetition.done + 1)
                repetition.done += 1
                if repetition.done >= repetition.remaining:
                    self._repetitions.pop(name, None)
        if self.motor_tested and now >= self.motor_tested_until:
            self.motor_tested, self.motor_throttle = 0, 0.0
        self._check_trigger()
        self._point_at_region()

    def _repeat(self, name: str, act: Callable[[int], None], period: float, count: float) -> None:
        if count > 0:
            period = max(period, 1 / _HIGHEST_RATE)
            self._repetitions[name] = _Repetition(act, period, count, self._autopilot.now + period)

    def _check_trigger(self) -> None:
        trigger, place = self._trigger, self._autopilot.maneuvers.place
        if trigger is not None and dist(trigger.last[:2], place[:2]) >= trigger.distance:
            trigger.last = place
            self.take_image()

    def _point_at_region(self) -> None:
        region = self.region_of_interest
        if region is not None:
            north, east, down = self._autopilot.maneuvers.place
            away = hypot(region[0] - north, region[1] - east)
            self.gimbal = Gimbal(
                pitch=atan2(down - region[2], away),
                yaw=atan2(region[1] - east, region[0] - north),
                yaw_locked=True,
            )

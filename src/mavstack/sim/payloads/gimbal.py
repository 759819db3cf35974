"""A simulated gimbal, managed by the autopilot as gimbal device 1.

It moves as `GimbalMotion` does: at a limited rate, within its ranges, stabilised against the vehicle's
attitude. Setpoints come from the gimbal manager; missions, mount commands and regions of interest set the
direction in the autopilot's payload, and the newest of both counts.
"""

from __future__ import annotations

from math import degrees
from typing import TYPE_CHECKING

from mavstack.services.gimbal import (
    GimbalInformation,
    GimbalManagerServer,
    GimbalMotion,
    GimbalSetpoint,
    VehiclePose,
)
from mavstack.services.gimbal.rotation import wrap
from mavstack.sim.vehicle_types import Firmware

if TYPE_CHECKING:
    from mavstack.services.gimbal import GimbalAttitude, GimbalValue
    from mavstack.sim.autopilot.payload import Gimbal
    from mavstack.sim.vehicle import SimulatedVehicle

#: Maximum rate of the gimbal, in degrees per second.
MAX_RATE = 90.0


class SimulatedGimbal:
    """The gimbal of a simulated vehicle; `attach` adds its manager to the autopilot."""

    def __init__(self, vehicle: SimulatedVehicle) -> None:
        self._vehicle = vehicle
        self._motion = GimbalMotion(
            GimbalInformation(1, vendor="Mavstack", model="Simulated gimbal"), max_rate=MAX_RATE
        )
        self._followed: Gimbal | None = None

    @property
    def information(self) -> GimbalInformation:
        """The abilities of the gimbal."""
        return self._motion.information

    def attach(self) -> None:
        """Add the gimbal manager to the autopilot, which is new at each boot."""
        vehicle = self._vehicle
        self._followed = vehicle.autopilot.payload.gimbal
        server = GimbalManagerServer(
            vehicle.address,
            [self],
            booted_at=vehicle.booted_at,
            pose=self._pose,
            open_control=vehicle.firmware is Firmware.ARDUPILOT,
        )
        server.answer(vehicle.commands, vehicle.messages, roi=False, now=vehicle.now)
        vehicle.engine.add(server)

    def apply(self, value: GimbalValue, now: float) -> None:
        """Follow a setpoint of the gimbal manager."""
        payload = self._vehicle.autopilot.payload
        payload.region_of_interest = None
        self._followed = payload.gimbal
        self._motion.apply(value, now)

    def advance(self, now: float, vehicle_heading: float | None) -> GimbalAttitude:
        """Turn until `now`, and return the attitude."""
        attitude = self._motion.advance(now, vehicle_heading)
        wanted = self._vehicle.autopilot.payload.gimbal
        if wanted is self._followed:
            return attitude
        self._followed = wanted
        self._motion.apply(_setpoint(wanted), now)
        return self._motion.advance(now, vehicle_heading)

    def _pose(self, now: float) -> VehiclePose:
        body = self._vehicle.body
        here = body.estimate
        latitude, longitude, altitude = body.frame.to_global(here.north, here.east, here.down)
        return VehiclePose(
            latitude, longitude, altitude, altitude - body.home.altitude, wrap(degrees(here.yaw))
        )


def _setpoint(gimbal: Gimbal) -> GimbalSetpoint:
    """Return the direction that a mission, a mount command or a region of interest set."""
    roll, pitch, yaw = (wrap(degrees(angle)) for angle in (gimbal.roll, gimbal.pitch, gimbal.yaw))
    return GimbalSetpoint(pitch, yaw, roll, yaw_lock=gimbal.yaw_locked)

"""ArduPilot's profile: Copter, Plane with and without lifting motors, Rover on land and water, Sub."""

from mavstack.sim.ardupilot.profile import ArdupilotProfile

__all__ = ["ArdupilotProfile"]

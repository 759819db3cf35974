"""ArduPilot's firmware profile: Copter, Plane, quadplanes, Rover, boats and Sub."""

from mavstack.sim.ardupilot.profile import ArdupilotProfile

__all__ = ["ArdupilotProfile"]

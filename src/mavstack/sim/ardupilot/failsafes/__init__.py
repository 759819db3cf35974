"""ArduPilot's failsafes: radio, ground station, battery, estimator, crash."""

from mavstack.sim.ardupilot.failsafes.factory import ArdupilotFailsafes

__all__ = ["ArdupilotFailsafes"]

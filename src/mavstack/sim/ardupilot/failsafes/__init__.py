"""ArduPilot's failsafes: of the radio, the ground station, the battery, the estimate, and what crashes."""

from mavstack.sim.ardupilot.failsafes.factory import ArdupilotFailsafes

__all__ = ["ArdupilotFailsafes"]

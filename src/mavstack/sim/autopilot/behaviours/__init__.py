"""Behaviours: the scripts that the modes of all firmwares run."""

from mavstack.sim.autopilot.behaviours.guided import Guided, Hold, Offboard
from mavstack.sim.autopilot.behaviours.hold import Brake, Stop
from mavstack.sim.autopilot.behaviours.land import Land
from mavstack.sim.autopilot.behaviours.manual import Acro, AltitudeHold, Manual, PositionHold, Stabilize
from mavstack.sim.autopilot.behaviours.mission import Mission
from mavstack.sim.autopilot.behaviours.orbit import Circle, Orbit
from mavstack.sim.autopilot.behaviours.return_home import ReturnToLaunch
from mavstack.sim.autopilot.behaviours.takeoff import Takeoff

__all__ = [
    "Acro",
    "AltitudeHold",
    "Brake",
    "Circle",
    "Guided",
    "Hold",
    "Land",
    "Manual",
    "Mission",
    "Offboard",
    "Orbit",
    "PositionHold",
    "ReturnToLaunch",
    "Stabilize",
    "Stop",
    "Takeoff",
]

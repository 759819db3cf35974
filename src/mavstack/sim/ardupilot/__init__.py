"""ArduPilot's flavour: Copter, Plane with and without lifting motors, Rover on land and water, Sub."""

from mavstack.sim.ardupilot.flavour import ArdupilotFlavour

__all__ = ["ArdupilotFlavour"]

"""PX4's flavour: multicopter, fixed wing, standard VTOL, rover, boat, submarine."""

from mavstack.sim.px4.flavour import Px4Flavour

__all__ = ["Px4Flavour"]

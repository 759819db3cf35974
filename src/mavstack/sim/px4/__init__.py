"""PX4's firmware profile: multicopter, fixed wing, standard VTOL, rover, boat, submarine."""

from mavstack.sim.px4.profile import Px4Profile

__all__ = ["Px4Profile"]

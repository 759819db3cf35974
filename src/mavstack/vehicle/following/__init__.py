"""Following a leader, by setpoints or by the firmware's own mode over a radio that carries no setpoints."""

from mavstack.vehicle.following.follow import follow

__all__ = ["follow"]

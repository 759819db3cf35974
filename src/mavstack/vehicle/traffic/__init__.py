"""Air traffic around the vehicles of a connection."""

from mavstack.vehicle.traffic.feed import TrafficAlarm, TrafficFeed

__all__ = ["TrafficAlarm", "TrafficFeed"]

"""Air traffic (ADSB_VEHICLE): the sender that shows vehicles the aircraft around them."""

from mavstack.services.traffic.sender import TrafficSender, to_message

__all__ = ["TrafficSender", "to_message"]

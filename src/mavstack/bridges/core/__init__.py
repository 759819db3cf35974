"""Mapping of MAVLink vehicles to the buses of robotics, without transports."""

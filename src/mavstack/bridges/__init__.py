"""Bridges: vehicles of other protocols as MAVLink vehicles."""

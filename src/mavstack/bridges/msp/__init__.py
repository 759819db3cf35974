"""The client of a flight controller that speaks MSP, and its bridge to MAVLink."""

from mavstack.bridges.msp.cli_session import CliSession
from mavstack.bridges.msp.flight_controller import FlightController

__all__ = ["CliSession", "FlightController"]

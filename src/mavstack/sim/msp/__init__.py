"""Simulated flight controllers of Betaflight and iNav, which speak MSP."""

from mavstack.sim.msp.controller import SimulatedFlightController

__all__ = ["SimulatedFlightController"]

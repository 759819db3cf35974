"""The autopilot of a simulated vehicle: modes, behaviours, missions, watches."""

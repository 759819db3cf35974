"""Simulated vehicles for tests, demonstrations and development without hardware.

Names are imported on first use: vehicle types and homes need neither numpy nor a world.
"""

from __future__ import annotations

from importlib import import_module

TYPE_CHECKING = False

if TYPE_CHECKING:
    from typing import Any

    from mavstack.sim.background import BackgroundSimulator
    from mavstack.sim.faults import FaultScript
    from mavstack.sim.fleet import Fleet
    from mavstack.sim.motion.obstacles import Obstacle
    from mavstack.sim.port import Port
    from mavstack.sim.rangefinders import Rangefinder
    from mavstack.sim.runner import Runner
    from mavstack.sim.simulation import Simulation
    from mavstack.sim.vehicle import SimulatedVehicle
    from mavstack.sim.vehicle_types import DEFAULT_HOME, Firmware, Home, TerrainSource, VehicleType
    from mavstack.sim.virtual import run_virtually

__all__ = [
    "DEFAULT_HOME",
    "BackgroundSimulator",
    "FaultScript",
    "Firmware",
    "Fleet",
    "Home",
    "Obstacle",
    "Port",
    "Rangefinder",
    "Runner",
    "SimulatedVehicle",
    "Simulation",
    "TerrainSource",
    "VehicleType",
    "run_virtually",
]

_LAZY_IMPORTS = {
    "DEFAULT_HOME": "vehicle_types",
    "BackgroundSimulator": "background",
    "FaultScript": "faults",
    "Firmware": "vehicle_types",
    "Fleet": "fleet",
    "Home": "vehicle_types",
    "Obstacle": "motion.obstacles",
    "Port": "port",
    "Rangefinder": "rangefinders",
    "Runner": "runner",
    "Simulation": "simulation",
    "SimulatedVehicle": "vehicle",
    "TerrainSource": "vehicle_types",
    "VehicleType": "vehicle_types",
    "run_virtually": "virtual",
}


def __getattr__(name: str) -> Any:  # noqa: ANN401 (any of the names above)
    module = _LAZY_IMPORTS.get(name)
    if module is None:
        raise AttributeError(f"module 'mavstack.sim' has no attribute {name!r}")
    value = getattr(import_module(f"mavstack.sim.{module}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(set(globals()) | set(__all__))

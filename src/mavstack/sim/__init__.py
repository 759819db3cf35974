"""Simulated vehicles that other people's software can fly.

Names are imported on first use: what a vehicle is called needs neither numpy nor a world.
"""

from __future__ import annotations

from importlib import import_module

TYPE_CHECKING = False

if TYPE_CHECKING:
    from typing import Any

    from mavstack.sim.background import Background
    from mavstack.sim.faults import FaultScript
    from mavstack.sim.fleet import Fleet
    from mavstack.sim.kinds import FIELD, Firmware, Home, VehicleType
    from mavstack.sim.runner import Runner
    from mavstack.sim.simulation import Simulation
    from mavstack.sim.vehicle import Port, Vehicle
    from mavstack.sim.virtual import run_virtually

__all__ = [
    "FIELD",
    "Background",
    "FaultScript",
    "Firmware",
    "Fleet",
    "Home",
    "Port",
    "Runner",
    "Simulation",
    "Vehicle",
    "VehicleType",
    "run_virtually",
]

_HOMES = {
    "FIELD": "kinds",
    "Background": "background",
    "FaultScript": "faults",
    "Firmware": "kinds",
    "Fleet": "fleet",
    "Home": "kinds",
    "Port": "vehicle",
    "Runner": "runner",
    "Simulation": "simulation",
    "Vehicle": "vehicle",
    "VehicleType": "kinds",
    "run_virtually": "virtual",
}


def __getattr__(name: str) -> Any:  # noqa: ANN401 (any of the names above)
    home = _HOMES.get(name)
    if home is None:
        raise AttributeError(f"module 'mavstack.sim' has no attribute {name!r}")
    value = getattr(import_module(f"mavstack.sim.{home}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(set(globals()) | set(__all__))

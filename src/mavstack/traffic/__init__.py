"""Air traffic, sans-IO: the formats of receivers (SBS, Beast, GDL 90), aircraft, closest approaches."""

from mavstack.traffic.aircraft import Aircraft, AircraftTable, Approach, Report, closest_approach
from mavstack.traffic.beast import BeastReader
from mavstack.traffic.gdl90 import Gdl90Reader
from mavstack.traffic.sbs import SbsReader

__all__ = [
    "Aircraft",
    "AircraftTable",
    "Approach",
    "BeastReader",
    "Gdl90Reader",
    "Report",
    "SbsReader",
    "closest_approach",
]

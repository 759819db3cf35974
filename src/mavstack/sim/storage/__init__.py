"""The storage of a simulated vehicle: its files, and its onboard logs."""

from mavstack.sim.storage.dataflash import DataflashWriter
from mavstack.sim.storage.dataflash_logs import DataflashLogs
from mavstack.sim.storage.flight_logs import DEFAULT_LOG_CAPACITY, FlightLogs, LogWriter
from mavstack.sim.storage.roots import ardupilot_root, file_store, px4_root
from mavstack.sim.storage.sample import FlightSample, LoggedParameter, LogStart
from mavstack.sim.storage.storage import Storage
from mavstack.sim.storage.ulog import UlogWriter, navigation_state
from mavstack.sim.storage.ulog_logs import UlogLogs

__all__ = [
    "DEFAULT_LOG_CAPACITY",
    "DataflashLogs",
    "DataflashWriter",
    "FlightLogs",
    "FlightSample",
    "LogStart",
    "LogWriter",
    "LoggedParameter",
    "Storage",
    "UlogLogs",
    "UlogWriter",
    "ardupilot_root",
    "file_store",
    "navigation_state",
    "px4_root",
]

"""The time synchronisation protocol: the offset of a remote clock (guide: time synchronization protocol)."""

from mavstack.services.timesync.client import TimeOffsetChanged, TimesyncClient
from mavstack.services.timesync.estimator import OffsetEstimator, TimeOffset
from mavstack.services.timesync.server import TimesyncServer

__all__ = ["OffsetEstimator", "TimeOffset", "TimeOffsetChanged", "TimesyncClient", "TimesyncServer"]

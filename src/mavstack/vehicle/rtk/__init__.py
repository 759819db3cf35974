"""Corrections for the satellite navigation of vehicles: sources, and the part `vehicle.rtk`."""

from mavstack.vehicle.rtk.feed import CorrectionFeed, FeedState, download_source_table
from mavstack.vehicle.rtk.rtk import Rtk, RtkStatus

__all__ = ["CorrectionFeed", "FeedState", "Rtk", "RtkStatus", "download_source_table"]

"""The tables of settings."""

from mavstack.msp.settings.tables.control import CONTROL
from mavstack.msp.settings.tables.filtering import FILTERING
from mavstack.msp.settings.tables.inav import INAV_SETTINGS
from mavstack.msp.settings.tables.vehicle import VEHICLE
from mavstack.msp.settings.tables.video import VIDEO

ALL_SETTINGS = CONTROL + FILTERING + VEHICLE + VIDEO + INAV_SETTINGS

__all__ = ["ALL_SETTINGS", "CONTROL", "FILTERING", "INAV_SETTINGS", "VEHICLE", "VIDEO"]

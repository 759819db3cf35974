"""Settings of flight controllers under stable names: definitions, and how they are read and written."""

from mavstack.msp.settings.definition import FieldPath, SettingDefinition, Value
from mavstack.msp.settings.settings import Settings

__all__ = ["FieldPath", "SettingDefinition", "Settings", "Value"]

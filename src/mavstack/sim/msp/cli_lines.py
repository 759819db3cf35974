"""Lines that several commands of the CLI print, and the features, which are bits of one setting."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.msp.messages.config import Feature, FeatureConfig, InavFeature
from mavstack.sim.msp.boxes import FIRST_STEP, STEP

if TYPE_CHECKING:
    from mavstack.sim.msp.boxes import ModeRange
    from mavstack.sim.msp.system import System


class Features:
    """The features of a firmware, by the names of the CLI.

    Args:
        system: The firmware.
    """

    def __init__(self, system: System) -> None:
        self._system = system
        self._kind: type[Feature | InavFeature] = InavFeature if system.is_inav else Feature

    @property
    def names(self) -> tuple[str, ...]:
        """All features."""
        return tuple(_name(each) for each in self._kind)

    def enabled(self) -> list[str]:
        """Return the features that are on."""
        return self._of(self._system.settings.get(FeatureConfig))

    def default(self) -> list[str]:
        """Return the features that are on by default."""
        return self._of(self._system.settings.default(FeatureConfig))

    def switch(self, name: str, on: bool) -> bool:
        """Switch a feature; False if there is none of this name."""
        found = next((each for each in self._kind if _name(each) == name), None)
        if found is None:
            return False
        bits = int(self._system.settings.get(FeatureConfig).features)
        bits = bits | found if on else bits & ~found
        self._system.settings.put(FeatureConfig(self._kind(bits)))
        return True

    def _of(self, config: FeatureConfig) -> list[str]:
        return [_name(each) for each in self._kind if each & config.features]


def _name(feature: Feature | InavFeature) -> str:
    """Return the name of a feature in the CLI."""
    return str(feature.name).replace("MOTOR_3D", "3D").replace("DASHBOARD", "DISPLAY")


def error(command: str, reason: str) -> str:
    """Return the text of an error."""
    return f"###ERROR IN {command}: {reason}###\n"


def aux_line(index: int, mode_range: ModeRange) -> str:
    """Return the line of a mode range."""
    start, end = (FIRST_STEP + STEP * step for step in (mode_range.start_step, mode_range.end_step))
    fields = (
        index,
        mode_range.permanent_id,
        mode_range.aux_channel,
        start,
        end,
        mode_range.logic,
        mode_range.linked_to,
    )
    return "aux " + " ".join(str(field) for field in fields)


def version_line(system: System) -> str:
    """Return the line with firmware, target, version, build and API."""
    info = system.info
    date, time, revision = info.build.rsplit(" ", 2)
    api = ".".join(str(number) for number in info.api)
    name = "INAV" if info.is_inav else info.firmware
    version = f"{info.version_text} {date} / {time} ({revision})"
    return f"# {name} / {info.target} ({info.board}) {version} MSP API: {api}"

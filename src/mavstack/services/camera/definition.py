"""The settings that a camera definition file describes, and the rules between them.

A setting is an extended parameter. Its definition says which values it takes (options, or a range), which
other settings an option excludes, and which options of another setting remain while it is chosen (guide:
camera definition file).
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from math import isfinite
from typing import TYPE_CHECKING, TypeAlias

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError

if TYPE_CHECKING:
    from collections.abc import Mapping

SettingValue: TypeAlias = int | float | str
Values: TypeAlias = "Mapping[str, object]"

_REALS = (common.MavParamExtType.REAL32, common.MavParamExtType.REAL64)
_TERM = re.compile(r"\s*(\w+)\s*(!=|=|<|>)\s*(\S+)\s*")
_JOINT = re.compile(r"\s+(AND|OR)\s+")


@dataclass(frozen=True, slots=True)
class OptionRange:
    """While an option is chosen, and the condition holds, another setting has these options alone.

    Attributes:
        setting: The other setting.
        options: Its remaining options by name.
        condition: Such as "CAM_EXPMODE=1"; "" if there is none.
    """

    setting: str
    options: Mapping[str, SettingValue]
    condition: str = ""

    def applies(self, values: Values) -> bool:
        """Return whether the condition holds for the present values."""
        if not self.condition:
            return True
        words = _JOINT.split(self.condition)
        outcome = _holds(words[0], values)
        for joint, term in zip(words[1::2], words[2::2], strict=True):
            held = _holds(term, values)
            outcome = outcome and held if joint == "AND" else outcome or held
        return outcome


@dataclass(frozen=True, slots=True)
class SettingOption:
    """One choice of a setting.

    Attributes:
        name: The name for people.
        value: The value of the parameter.
        excludes: The settings that have no effect while the option is chosen.
        ranges: The options of other settings that remain.
    """

    name: str
    value: SettingValue
    excludes: tuple[str, ...] = ()
    ranges: tuple[OptionRange, ...] = ()


@dataclass(frozen=True, slots=True)
class CameraSetting:
    """One setting of a camera.

    Attributes:
        name: The name of the extended parameter.
        type: Its MAV_PARAM_EXT_TYPE.
        default: The value after a reset.
        description: One line for people.
        options: The choices; empty if any value of the range is allowed.
        minimum: The smallest value; None: no limit.
        maximum: The largest value; None: no limit.
        step: The step between values; None: any.
        unit: The unit; "" if there is none.
        control: False if user interfaces should not show the setting.
        readonly: True if only the camera sets it.
        writeonly: True if the camera does not tell its value.
        updates: The settings to read again after a change of this one.
        is_bool: True if the values are 0 and 1 only.
    """

    name: str
    type: int
    default: SettingValue
    description: str = ""
    options: tuple[SettingOption, ...] = ()
    minimum: float | None = None
    maximum: float | None = None
    step: float | None = None
    unit: str = ""
    control: bool = True
    readonly: bool = False
    writeonly: bool = False
    updates: tuple[str, ...] = ()
    is_bool: bool = False

    def option(self, value: object) -> SettingOption | None:
        """Return the option with a value."""
        return next((each for each in self.options if _same(each.value, value)), None)

    def text(self, value: object) -> str:
        """Return a value for people: the name of its option, or the value with its unit."""
        option = self.option(value)
        if option is not None:
            return option.name
        if self.is_bool:
            return "on" if value else "off"
        shown = f"{value:g}" if isinstance(value, float) else str(value)
        return f"{shown} {self.unit}".rstrip()

    def parse(self, text: object) -> SettingValue:
        """Return the value that a word stands for: the name of an option, or a number.

        Raises:
            InvalidArgumentError: The word is neither.
        """
        wanted = str(text).strip()
        for option in self.options:
            if option.name.casefold() == wanted.casefold():
                return option.value
        if self.is_bool and wanted.casefold() in ("on", "true", "off", "false"):
            return int(wanted.casefold() in ("on", "true"))
        if self.type == common.MavParamExtType.CUSTOM:
            return wanted
        value = number(wanted, self.type)
        if value is None:
            raise InvalidArgumentError(f"setting {self.name}: {wanted!r} is no {self._expected()}")
        return value

    def check(self, value: object, options: Mapping[str, SettingValue] | None = None) -> None:
        """Raise unless the setting takes a value.

        Args:
            value: The value.
            options: The options that remain at present; None: all.

        Raises:
            InvalidArgumentError: The value is no option, out of range, or the setting cannot be set.
        """
        if self.readonly:
            raise InvalidArgumentError(f"setting {self.name} can only be read")
        if self.options:
            allowed = {each.name: each.value for each in self.options} if options is None else options
            if not any(_same(value, each) for each in allowed.values()):
                names = ", ".join(allowed) or "none at present"
                raise InvalidArgumentError(f"setting {self.name} cannot be {value}; options: {names}")
            return
        if isinstance(value, int | float) and not self._in_range(value):
            raise InvalidArgumentError(
                f"setting {self.name} cannot be {value}; it takes a {self._expected()}"
            )

    def _in_range(self, value: float) -> bool:
        if self.is_bool:
            return value in (0, 1)
        low = self.minimum is None or value >= self.minimum
        return isfinite(value) and low and (self.maximum is None or value <= self.maximum)

    def _expected(self) -> str:
        if self.is_bool:
            return "value on or off"
        if self.options:
            return "option; options: " + ", ".join(each.name for each in self.options)
        limits = [] if self.minimum is None else [f"from {self.minimum:g}"]
        limits += [] if self.maximum is None else [f"to {self.maximum:g}"]
        return " ".join(["number", *limits])


@dataclass(frozen=True, slots=True)
class CameraDefinition:
    """The content of a camera definition file.

    Attributes:
        model: The model of the camera.
        vendor: Its maker.
        version: The version of the file.
        settings: The settings by name, in the order of the file.
    """

    model: str = ""
    vendor: str = ""
    version: int = 0
    settings: Mapping[str, CameraSetting] = field(default_factory=dict)

    def excluded(self, values: Values) -> frozenset[str]:
        """Return the settings that have no effect with the present values."""
        found: set[str] = set()
        for option in self._chosen(values):
            found.update(option.excludes)
        return frozenset(found)

    def options_of(self, name: str, values: Values) -> Mapping[str, SettingValue]:
        """Return the options of a setting that remain with the present values, by name."""
        allowed = {option.name: option.value for option in self._setting(name).options}
        for option in self._chosen(values):
            for limit in option.ranges:
                if limit.setting == name and limit.applies(values):
                    kept = list(limit.options.values())
                    allowed = {
                        key: value for key, value in allowed.items() if any(_same(value, one) for one in kept)
                    }
        return allowed

    def check(self, name: str, value: object, values: Values) -> None:
        """Raise unless a setting takes a value while the others have the present ones.

        Raises:
            InvalidArgumentError: There is no such setting, it is excluded at present, or it does not take
                the value.
        """
        setting = self._setting(name)
        for option in self._chosen(values):
            if name in option.excludes:
                raise InvalidArgumentError(f"setting {name} has no effect with {option.name}")
        setting.check(value, self.options_of(name, values) if setting.options else None)

    def _setting(self, name: str) -> CameraSetting:
        setting = self.settings.get(name)
        if setting is None:
            known = ", ".join(self.settings) or "none"
            raise InvalidArgumentError(f"the camera has no setting {name}; its settings: {known}")
        return setting

    def _chosen(self, values: Values) -> list[SettingOption]:
        """Return the options that the present values choose."""
        chosen = (each.option(values[each.name]) for each in self.settings.values() if each.name in values)
        return [option for option in chosen if option is not None]


def number(text: str, kind: int) -> int | float | None:
    """Return the number of a type in a text; None if it is none."""
    try:
        if kind in _REALS:
            value: int | float = float(text)
        else:
            value = int(text, 0) if text.strip().lower().startswith("0x") else int(text)
    except ValueError:
        return None
    return value if isfinite(value) else None


def _holds(term: str, values: Values) -> bool:
    match = _TERM.fullmatch(term)
    if match is None or match[1] not in values:
        return False
    present, operator, wanted = values[match[1]], match[2], match[3]
    if operator in "=!=":
        return (str(present) == wanted or _same(present, _float(wanted))) == (operator == "=")
    number_now, limit = _float(present), _float(wanted)
    if number_now is None or limit is None:
        return False
    return number_now < limit if operator == "<" else number_now > limit


def _float(value: object) -> float | None:
    try:
        return float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        return None


def _same(one: object, other: object) -> bool:
    """Return whether two values are equal; numbers as closely as a 32-bit float."""
    if isinstance(one, int | float) and isinstance(other, int | float):
        return one == other or abs(one - other) <= 1e-6 * max(abs(one), abs(other))
    return one == other

"""`dump` and `diff` of the CLI: the settings as lines that the CLI takes again."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.sim.msp.cli_lines import aux_line, version_line
from mavstack.sim.msp.receiver import letters_of
from mavstack.sim.msp.settings import PROFILES

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from mavstack.sim.msp.cli_lines import Features
    from mavstack.sim.msp.cli_settings import CliSetting
    from mavstack.sim.msp.system import System

#: The parts of a dump, by scope; an empty scope means the master settings and the selected profiles.
_SCOPES: Final = {
    "": ("master", "profile", "rates"),
    "all": ("master", "profiles", "restore"),
    "master": ("master",),
    "profile": ("profile",),
    "rates": ("rates",),
}


class Dump:
    """The lines of one dump.

    Args:
        system: The firmware.
        features: Its features.
        diff: Leave out what has its default.
    """

    def __init__(self, system: System, features: Features, *, diff: bool) -> None:
        self._system, self._features, self._diff = system, features, diff
        self._store = system.settings

    def text(self, scope: str) -> str:
        """Return the lines.

        Args:
            scope: "all", "master", "profile" or "rates"; empty for master and the selected profiles.
        """
        parts = _SCOPES.get(scope, _SCOPES[""])
        lines: list[str] = []
        if "master" in parts:
            lines += self._master(is_complete=scope == "all")
        if "profiles" in parts:
            lines += self._all_profiles()
        if "profile" in parts:
            lines += self._profile(self._store.pid_profile)
        if "rates" in parts and self._store.facts.rate_profile:
            lines += self._rate_profile(self._store.rate_profile)
        if "restore" in parts:
            lines += self._restore()
        elif "master" in parts:
            lines += ["", "# end the command batch", "batch end"]
        return "\n".join(lines) + "\n"

    def _master(self, *, is_complete: bool) -> Iterator[str]:
        yield from ("", "# version", version_line(self._system))
        yield from ("", "# start the command batch", "batch start")
        if is_complete and self._diff:
            yield from ("", "# reset configuration to default settings", "defaults nosave")
        if is_complete:
            yield from ("", f"mcu_id {self._system.info.uid}", "signature ")
        yield from self._section("feature", self._feature_lines())
        channel_map = letters_of(self._system.receiver.channel_map)
        if not self._diff or channel_map != self._system.default_channel_map:
            yield from self._section("map", [f"map {channel_map}"])
        yield from self._section("aux", self._aux_lines())
        yield from self._section("master", self._setting_lines(self._kinds("master")))

    def _section(self, name: str, lines: Iterable[str]) -> Iterator[str]:
        """Yield lines below a heading, and nothing if there are none in a diff."""
        lines = list(lines)
        if lines or not self._diff:
            yield from ("", f"# {name}", *lines)

    def _feature_lines(self) -> Iterator[str]:
        enabled, default = self._features.enabled(), self._features.default()
        off = default if self._diff else self._features.names
        yield from (f"feature -{name}" for name in off if name not in enabled or not self._diff)
        yield from (f"feature {name}" for name in enabled if name not in default or not self._diff)

    def _aux_lines(self) -> Iterator[str]:
        default = self._store.facts.mode_ranges
        for index, each in enumerate(self._store.mode_ranges):
            known = default[index] if index < len(default) else type(each)()
            if not self._diff or each != known:
                yield aux_line(index, each)

    def _kinds(self, scope: str) -> list[CliSetting]:
        facts = self._store.facts
        found = []
        for each in self._system.cli_settings:
            place = "profile" if each.kind in facts.pid_profile else "master"
            place = "rates" if each.kind in facts.rate_profile else place
            if place == scope:
                found.append(each)
        return found

    def _setting_lines(self, settings: Iterable[CliSetting]) -> Iterator[str]:
        for each in settings:
            value = each.shown(self._store)
            if not self._diff or value != each.shown(self._store, default=True):
                yield f"set {each.name} = {value}"

    def _profile(self, index: int) -> Iterator[str]:
        yield from ("", f"profile {index}")
        selected = self._store.pid_profile
        self._store.select(index, is_rate_profile=False)
        yield from self._section(f"profile {index}", self._setting_lines(self._kinds("profile")))
        self._store.select(selected, is_rate_profile=False)

    def _rate_profile(self, index: int) -> Iterator[str]:
        yield from ("", f"rateprofile {index}")
        selected = self._store.rate_profile
        self._store.select(index, is_rate_profile=True)
        yield from self._section(f"rateprofile {index}", self._setting_lines(self._kinds("rates")))
        self._store.select(selected, is_rate_profile=True)

    def _all_profiles(self) -> Iterator[str]:
        for index in range(PROFILES):
            yield from self._profile(index)
        yield from ("", "# restore original profile selection", f"profile {self._store.pid_profile}")
        for index in range(PROFILES if self._store.facts.rate_profile else 0):
            yield from self._rate_profile(index)

    def _restore(self) -> Iterator[str]:
        if self._store.facts.rate_profile:
            selected = f"rateprofile {self._store.rate_profile}"
            yield from ("", "# restore original rateprofile selection", selected)
        yield from ("", "# save configuration", "save")

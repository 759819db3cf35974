"""The commands of the CLI: settings, switches, features, profiles, dumps, and the way back.

`diff all` and `dump` are lines that the CLI takes again, so that their text restores a controller.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.sim.msp.boxes import FIRST_STEP, STEP, ModeRange
from mavstack.sim.msp.cli_dump import Dump
from mavstack.sim.msp.cli_lines import Features, aux_line, error, version_line
from mavstack.sim.msp.receiver import AUX, CHANNELS, letters_of, map_of
from mavstack.sim.msp.settings import PROFILES
from mavstack.sim.msp.system import RefusedError

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.sim.msp.cli_settings import CliSetting
    from mavstack.sim.msp.system import System

#: The help text of each command of the command line interface.
HELP: Final = {
    "aux": "configure modes\n\t<index> <mode> <aux> <start> <end> <logic>",
    "batch": "start or end a batch of commands\n\tstart | end",
    "defaults": "reset to defaults and reboot\n\t{nosave}",
    "diff": "list configuration changes from default\n\t[master|profile|rates|all]",
    "dump": "dump configuration\n\t[master|profile|rates|all]",
    "exit": "exit command line interface and reboot",
    "feature": "configure features\n\tlist\n\t<->[name]",
    "get": "get variable value\n\t[name]",
    "help": "display command help\n\t[search string]",
    "map": "configure rc channel order\n\t[<map>]",
    "mcu_id": "id of the microcontroller",
    "profile": "change profile\n\t[<index>]",
    "rateprofile": "change rate profile\n\t[<index>]",
    "save": "save and reboot",
    "set": "change setting\n\t[<name>=<value>]",
    "signature": "get / set the board type signature\n\t[signature]",
    "status": "show status",
    "version": "show version",
}
_HIGHEST_PULSE: Final = 2100


class CliCommands:
    """The commands of one controller.

    Args:
        system: The firmware.
    """

    def __init__(self, system: System) -> None:
        self._system, self._features = system, Features(system)
        self.commands: dict[str, Callable[[str], str]] = {
            "aux": self._aux,
            "batch": self._batch,
            "board_name": lambda text: f"board_name {text}\n",
            "defaults": self._defaults,
            "diff": lambda text: self._dump(text, diff=True),
            "dump": lambda text: self._dump(text, diff=False),
            "exit": self._exit,
            "feature": self._feature,
            "get": self._get,
            "help": self._help,
            "manufacturer_id": lambda text: f"manufacturer_id {text}\n",
            "map": self._map,
            "mcu_id": lambda _: f"mcu_id {system.info.uid}\n",
            "profile": lambda text: self._profile(text, is_rate_profile=False),
            "rateprofile": lambda text: self._profile(text, is_rate_profile=True),
            "save": self._save,
            "set": self._set,
            "signature": lambda text: f"signature {text}\n",
            "status": lambda _: self._status(),
            "version": lambda _: self._version(),
        }

    # --- settings

    def _get(self, text: str) -> str:
        found = self._system.cli_settings.containing(text)
        if not found:
            return error("get", f"INVALID NAME: {text}")
        return "\n".join(self._described(setting, full=len(found) == 1) for setting in found)

    def _described(self, setting: CliSetting, *, full: bool) -> str:
        """Return the value of a setting, where it is kept, its limits and its default."""
        store = self._system.settings
        value, default = setting.shown(store), setting.shown(store, default=True)
        lines = [f"{setting.name} = {value}"]
        if setting.kind in store.facts.pid_profile:
            lines.append(f"profile {store.pid_profile}")
        elif setting.kind in store.facts.rate_profile:
            lines.append(f"rateprofile {store.rate_profile}")
        lines.append(setting.limits)
        if full and value != default:
            lines.append(f"Default value: {default}")
        return "\n".join(lines) + "\n"

    def _set(self, text: str) -> str:
        if not text or text == "*":
            lines = (
                f"{each.name} = {each.shown(self._system.settings)}" for each in self._system.cli_settings
            )
            return "Current settings: \n" + "\n".join(lines) + "\n"
        name, equals, value = (part.strip() for part in text.partition("="))
        if not equals:
            return self._get(text)
        setting = self._system.cli_settings.get(name)
        if setting is None:
            return error("set", "INVALID NAME")
        parsed = setting.parse(value)
        if parsed is None:
            return error("set", "INVALID VALUE") + f"{setting.limits}\n"
        setting.store(self._system.settings, parsed)
        self._system.configure()
        return f"{setting.name} set to {setting.shown(self._system.settings)}"

    # --- switches, features, channels

    def _aux(self, text: str) -> str:
        ranges = self._system.settings.mode_ranges
        if not text:
            return "".join(f"{aux_line(index, each)}\n" for index, each in enumerate(ranges))
        try:
            index, box, channel, start, end, *rest = (int(word) for word in text.split())
        except ValueError:
            return error("aux", "INVALID ARGUMENT COUNT")
        if not 0 <= index < len(ranges):
            return error("aux", f"INDEX NOT BETWEEN 0 AND {len(ranges) - 1}")
        logic, linked_to = (*rest, 0, 0)[:2]
        if not (
            box in self._system.boxes
            and linked_to in self._system.boxes
            and channel in range(CHANNELS - AUX)
            and all(FIRST_STEP <= each <= _HIGHEST_PULSE for each in (start, end))
            and logic in (0, 1)
        ):
            return error("aux", "ARGUMENT OUT OF RANGE")
        steps = (start - FIRST_STEP) // STEP, (end - FIRST_STEP) // STEP
        ranges[index] = ModeRange(box, channel, *steps, logic, linked_to)
        return aux_line(index, ranges[index])

    def _feature(self, text: str) -> str:
        features = self._features
        if text in ("", "list"):
            enabled = features.enabled()
            others = [name for name in features.names if name not in enabled]
            return f"Enabled:  {' '.join(enabled)}\nAvailable:  {' '.join(others)}\n"
        on, name = not text.startswith("-"), text.removeprefix("-").upper()
        if not features.switch(name, on):
            return error("feature", f"INVALID NAME: {text}")
        return f"{'Enabled' if on else 'Disabled'} {name}"

    def _map(self, text: str) -> str:
        system = self._system
        if text:
            try:
                positions = map_of(text.upper())
            except ValueError:
                return error("map", "INVALID RC MAP")
            mapped = positions[: len(system.default_channel_map)]
            if sorted(mapped) != list(range(len(mapped))):
                return error("map", "INVALID RC MAP")
            system.set_channel_map(positions)
        return f"map {letters_of(system.receiver.channel_map)}\n"

    # --- profiles, batches, dumps

    def _profile(self, text: str, *, is_rate_profile: bool) -> str:
        store, name = self._system.settings, "rateprofile" if is_rate_profile else "profile"
        if text:
            if not text.isdecimal() or int(text) >= PROFILES:
                return error(name, f"PROFILE OUTSIDE OF [0..{PROFILES - 1}]")
            store.select(int(text), is_rate_profile=is_rate_profile)
        return f"{name} {store.rate_profile if is_rate_profile else store.pid_profile}\n"

    def _batch(self, text: str) -> str:
        if text not in ("start", "end"):
            return error("batch", "PARSING FAILED")
        return f"Command batch {'started' if text == 'start' else 'ended'}\n"

    def _dump(self, text: str, *, diff: bool) -> str:
        scope = text.partition(" ")[0]
        return Dump(self._system, self._features, diff=diff).text(scope)

    # --- state

    def _status(self) -> str:
        system = self._system
        battery, now = system.body.battery, system.now
        reasons = " ".join(name.replace("_", "") for name in system.arming.reasons)
        fix = "FIX" if system.has_fix else "NO FIX"
        return "\n".join(
            (
                f"MCU {system.info.target} Clock=168MHz",
                "GYRO: (1) SIMULATED enabled",
                "ACC: SIMULATED",
                "BARO: SIMULATED",
                f"GPS: connected, {system.body.sensors.gps_satellites} satellites, {fix}",
                f"System Uptime: {int(now - system.booted_at)} seconds",
                "CPU:8%, cycle time: 125, GYRO rate: 8000, RX rate: 50, System rate: 9",
                f"Voltage: {battery.voltage:.2f}V ({battery.cells}S battery - OK)",
                f"Arming disable flags: {reasons}".rstrip(),
                "",
            )
        )

    def _version(self) -> str:
        return f"{version_line(self._system)}\n"

    def _help(self, text: str) -> str:
        found = {name: about for name, about in HELP.items() if text in name}
        if not found:
            return f"NO MATCHES FOR '{text}'\n"
        return "".join(f"{name} - {about}\n" for name, about in found.items())

    # --- save and exit

    def _save(self, _: str) -> str:
        try:
            self._system.save()
        except RefusedError:
            return error("save", "CANNOT SAVE WHILE ARMED")
        self._system.host.request_reboot()
        return "Saving\n\nRebooting"

    def _exit(self, _: str) -> str:
        self._system.host.request_reboot()
        return "\n# leaving CLI mode, unsaved changes lost\n\nRebooting"

    def _defaults(self, text: str) -> str:
        self._system.settings.reset()
        self._system.configure()
        if text == "nosave":
            return "\n# resetting to defaults\n"
        self._system.save()
        self._system.host.request_reboot()
        return "\n# resetting to defaults\n\nRebooting"

"""PX4's failsafes: of all that is wrong, the most urgent action is done; then the chosen mode goes on.

Somebody chose a mode; a failsafe flies another one in its place. Before most actions the vehicle holds for
COM_FAIL_ACT_T seconds, so that a pilot may take over: choosing a mode meanwhile, or later, leaves it at a
warning until something else goes wrong. When what was wrong is right again, the chosen mode is flown on, but
for lost links, whose action lasts until a mode is chosen.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.sim.px4 import modes
from mavstack.sim.px4.failsafe_actions import BY_ITSELF, WARNINGS, WORDS, Act, Until, Wanted
from mavstack.sim.px4.failsafe_checks import Px4Checks

if TYPE_CHECKING:
    from mavstack.sim.autopilot.interfaces import Autopilot

_CRITICAL, _WARNING = common.MavSeverity.CRITICAL, common.MavSeverity.WARNING
_EMERGENCY: Final = common.MavSeverity.EMERGENCY
#: These are done at once.
_NEVER_DELAYED: Final = frozenset({Act.NONE, Act.WARN, Act.HOLD, Act.DISARM, Act.TERMINATE})
#: Not more than this, and there is no time to take over.
_NO_DELAY: Final = 0.1
_DISENGAGED: Final = frozenset({Act.DESCEND, Act.ALTITUDE, Act.STABILIZED})
_SEVERITIES: Final = {"Low battery level": _WARNING, "Emergency battery level": _EMERGENCY}

#: Why such a mode was entered.
SETPOINTS_LOST: Final = "offboard failsafe"
_OFFBOARD_TERMINATE, _OFFBOARD_DISARM = 6, 7
_OFFBOARD_ACTIONS: Final = MappingProxyType(
    {0: modes.POSITION, 1: modes.ALTITUDE, 2: modes.STABILIZED, 3: modes.RETURN, 4: modes.LAND, 5: modes.HOLD}
)
_OFFBOARD_FALLBACKS: Final = (modes.RETURN, modes.LAND, modes.DESCEND, modes.HOLD)


class Px4Failsafes:
    """The failsafes of one vehicle; one of its autopilot's watches."""

    def __init__(self, autopilot: Autopilot) -> None:
        self._autopilot = autopilot
        self._checks = Px4Checks(autopilot)
        #: What is wanted, by what it is for.
        self._wanted: dict[str, Wanted] = {}
        #: The mode that somebody chose, and the one that is flown.
        self._intended = self._flown = autopilot.mode.number
        self._act = Act.NONE
        self._taken_over = self._was_armed = False
        self._hold_until = autopilot.now
        #: The cause of what was newly wanted at this look; None if there is nothing new.
        self._new_cause: str | None = None
        autopilot.watches.append(self)

    def tick(self, now: float) -> None:
        """Look, and act."""
        autopilot = self._autopilot
        chosen = autopilot.mode.number != self._flown
        if chosen:
            self._intended = self._flown = autopilot.mode.number
            if autopilot.mode_reason != SETPOINTS_LOST:
                autopilot.failsafes.discard("offboard")
        self._checks.look(now)
        if autopilot.armed != self._was_armed or chosen or self._taken_over:
            self._drop_what_lasts(until_mode_changes=True)
        if autopilot.armed != self._was_armed:
            self._was_armed, self._taken_over = autopilot.armed, False
        self._collect(now)
        if not autopilot.armed or autopilot.terminated:
            self._settle(Act.TERMINATE if autopilot.terminated else Act.NONE)
            return
        self._look_after_delay()
        act, later, cause = self._select(now, chosen=chosen)
        self._notify(now, act, later, cause)
        self._do(act)

    # What is wanted

    def _drop_what_lasts(self, *, until_mode_changes: bool) -> None:
        self._wanted = {
            name: wanted
            for name, wanted in self._wanted.items()
            if wanted.failing or not (until_mode_changes and wanted.until is Until.MODE_CHANGES)
        }

    def _collect(self, now: float) -> None:
        """Ask the checks; what is not wanted any more goes, or stays until its end."""
        self._new_cause = None
        found = dict(self._checks.wanted(self._intended))
        for name, wanted in found.items():
            before = self._wanted.get(name)
            if before is not None:
                before.act, before.failing = wanted.act, True
                continue
            self._wanted[name] = wanted
            self._begin(wanted, now)
        for name in [name for name in self._wanted if name not in found]:
            if self._wanted[name].until is Until.CONDITION_CLEARS:
                del self._wanted[name]
            else:
                self._wanted[name].failing = False

    def _begin(self, wanted: Wanted, now: float) -> None:
        patience = float(self._autopilot.vehicle.parameters["COM_FAIL_ACT_T"])
        delayed = wanted.delayed and wanted.takeover and patience > _NO_DELAY
        if delayed and wanted.act > Act.WARN and now >= self._hold_until:
            self._hold_until = now + patience
        if wanted.act is not Act.NONE:
            self._new_cause = wanted.cause
        if wanted.act >= Act.HOLD:
            self._taken_over = False

    def _look_after_delay(self) -> None:
        if self._act > Act.HOLD or self._taken_over or not self._checks.can_run(modes.HOLD):
            self._hold_until = self._autopilot.now

    # Which of it is done

    def _select(self, now: float, *, chosen: bool) -> tuple[Act, Act, str]:
        """What is done, what will be done after holding, and why."""
        urgent = max(self._wanted.values(), key=lambda wanted: wanted.act, default=Wanted(Act.NONE))
        act, later, cause = urgent.act, Act.NONE, urgent.cause
        may_take_over = all(wanted.takeover for wanted in self._wanted.values() if wanted.act)
        if now < self._hold_until and not self._taken_over and may_take_over and act not in _NEVER_DELAYED:
            act, later = Act.HOLD, act
        self._taken_over = (
            may_take_over and act in BY_ITSELF and (self._taken_over or (chosen and self._act > Act.WARN))
        )
        if self._taken_over:
            act, later = max(Act.WARN, self._checks.fallback_of(self._intended)), Act.NONE
        done = self._checks.possible(act)
        if Act.RETURN in (done, later) and self._comes_down_anyway():
            return Act.WARN, Act.NONE, cause
        return done, later, cause if done is act else ""

    def _comes_down_anyway(self) -> bool:
        on_its_way = self._intended in (modes.LAND, modes.RETURN)
        return on_its_way and self._checks.can_run(self._intended)

    # Doing it

    def _do(self, act: Act) -> None:
        autopilot = self._autopilot
        self._settle(act)
        if act is Act.TERMINATE:
            autopilot.terminate()
        elif act is Act.DISARM:
            autopilot.disarm("failsafe")
        else:
            wanted = self._intended if act in (Act.NONE, Act.WARN) else self._checks.mode_of(act)
            if autopilot.mode.number != wanted:
                autopilot.enter(wanted, "failsafe" if act > Act.WARN else "failsafe ended")
        self._flown = autopilot.mode.number

    def _settle(self, act: Act) -> None:
        """The state of the vehicle is critical while more is done than warning."""
        self._act = act
        failsafes, acting = self._autopilot.failsafes, {name for name, it in self._wanted.items() if it.act}
        failsafes -= {name for name in _NAMES if name not in acting or act <= Act.WARN}
        if act > Act.WARN:
            failsafes |= acting
        if not self._autopilot.armed or self._autopilot.guided.stream_alive:
            failsafes.discard("offboard")

    # Saying it

    def _notify(self, now: float, act: Act, later: Act, cause: str) -> None:
        if act > self._act:
            self._tell(act, later, cause, max(self._hold_until - now, 0.0))
        elif self._new_cause is not None:
            self._tell(Act.WARN, Act.NONE, self._new_cause, 0.0)

    def _tell(self, act: Act, later: Act, cause: str, delay: float) -> None:
        if act is Act.WARN:
            if cause:
                text = WARNINGS.get(cause, f"Failsafe warning: {cause}")
                self._send_statustext(
                    text, _SEVERITIES.get(cause, _CRITICAL if cause in WARNINGS else _WARNING)
                )
            return
        before = cause or "Failsafe activated"
        if act is Act.HOLD and later is not Act.NONE:
            self._send_statustext(f"{before}: switching to {WORDS[later]} in {delay:.0f} seconds")
            self._send_statustext(f"Failsafe activated: entering Hold for {delay:.0f} seconds")
            return
        if not cause and act in _DISENGAGED:
            before += ": Autopilot disengaged, switching to " + WORDS[act]
        else:
            before += ": switching to " + WORDS[act]
        self._send_statustext(before)
        if act is not Act.TERMINATE:  # which the profile tells, whoever terminates
            self._send_statustext("Failsafe activated")

    def _send_statustext(self, text: str, severity: int = _CRITICAL) -> None:
        self._autopilot.vehicle.send_statustext(text, severity)


#: What the checks call it.
_NAMES: Final = frozenset(
    {"manual control", "ground station", "battery 1", "battery 2", "battery 3", "motor", "mode"}
)


def setpoints_lost(autopilot: Autopilot) -> None:
    """Do it, and say so."""
    autopilot.vehicle.send_statustext("Failsafe activated", _CRITICAL)
    autopilot.failsafes.add("offboard")
    action = int(autopilot.vehicle.parameters["COM_OBL_RC_ACT"])
    if action == _OFFBOARD_TERMINATE:
        autopilot.terminate()
    elif action == _OFFBOARD_DISARM:
        autopilot.disarm("failsafe")
    else:
        _enter_first(autopilot, _OFFBOARD_ACTIONS.get(action, modes.POSITION))


def _enter_first(autopilot: Autopilot, wanted: int) -> None:
    for number in (wanted, *_OFFBOARD_FALLBACKS):
        mode = autopilot.find_mode(number)
        if mode is None or (mode.manual_control and not autopilot.radio.present):
            continue
        if autopilot.enter(number, SETPOINTS_LOST):
            return

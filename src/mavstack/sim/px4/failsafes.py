"""PX4's failsafes: of all requested actions the most urgent one is executed; then the chosen mode continues.

The user chose a mode; a failsafe flies another mode instead. Before most actions the vehicle holds for
COM_FAIL_ACT_T seconds, so that a pilot can take over: a mode change during the delay or later reduces the
action to a warning until another condition fails. When a condition clears, the chosen mode is resumed, except
after a link loss, whose action lasts until a mode is chosen.

When the setpoints of Offboard stop, COM_OBL_RC_ACT selects the mode. The pilot's modes need a pilot; without
one, Return, Land and Descend are tried in turn.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.sim.px4 import modes
from mavstack.sim.px4.failsafe_actions import (
    ACTION_NAMES,
    AUTOMATIC_ACTIONS,
    WARNINGS,
    Action,
    ActionEnd,
    ActionRequest,
)
from mavstack.sim.px4.failsafe_checks import FailsafeChecks

if TYPE_CHECKING:
    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot

_CRITICAL, _WARNING = common.MavSeverity.CRITICAL, common.MavSeverity.WARNING
_EMERGENCY: Final = common.MavSeverity.EMERGENCY
#: Actions that are taken without the delay of COM_FAIL_ACT_T.
_NEVER_DELAYED: Final = frozenset({Action.NONE, Action.WARN, Action.HOLD, Action.DISARM, Action.TERMINATE})
#: A value of COM_FAIL_ACT_T up to this, in seconds, means no delay.
_NO_DELAY: Final = 0.1
_DISENGAGED: Final = frozenset({Action.DESCEND, Action.ALTITUDE, Action.STABILIZED})
_SEVERITIES: Final = {"Low battery level": _WARNING, "Emergency battery level": _EMERGENCY}

#: The reason of the mode change after setpoints are lost.
SETPOINTS_LOST: Final = "offboard failsafe"
_OFFBOARD_TERMINATE, _OFFBOARD_DISARM = 6, 7
_OFFBOARD_ACTIONS: Final = MappingProxyType(
    {0: modes.POSITION, 1: modes.ALTITUDE, 2: modes.STABILIZED, 3: modes.RETURN, 4: modes.LAND, 5: modes.HOLD}
)
_OFFBOARD_FALLBACKS: Final = (modes.RETURN, modes.LAND, modes.DESCEND, modes.HOLD)


class Px4Failsafes:
    """The failsafes of one vehicle; one of the autopilot's periodic checks."""

    def __init__(self, autopilot: SimulatedAutopilot) -> None:
        self._autopilot = autopilot
        self._checks = FailsafeChecks(autopilot)
        #: The requested action of each active condition, by name.
        self._requests: dict[str, ActionRequest] = {}
        #: The mode that the user selected, and the mode that is flown, which a failsafe may have changed.
        self._intended = self._actual = autopilot.mode.number
        self._action = Action.NONE
        self._taken_over = self._was_armed = False
        self._hold_until = autopilot.now
        #: Name of the condition that was added last in this update; None if no condition was added.
        self._new_cause: str | None = None
        autopilot.watches.append(self)

    def tick(self, now: float) -> None:
        """Check all conditions and act."""
        autopilot = self._autopilot
        chosen = autopilot.mode.number != self._actual
        if chosen:
            self._intended = self._actual = autopilot.mode.number
            if autopilot.mode_reason != SETPOINTS_LOST:
                autopilot.failsafes.discard("offboard")
        self._checks.update(now)
        if autopilot.armed != self._was_armed or chosen or self._taken_over:
            self._drop_ended(mode_changed=True)
        if autopilot.armed != self._was_armed:
            self._was_armed, self._taken_over = autopilot.armed, False
        self._collect(now)
        if not autopilot.armed or autopilot.terminated:
            self._update_state(Action.TERMINATE if autopilot.terminated else Action.NONE)
            return
        self._end_delay()
        action, later, cause = self._select(now, chosen=chosen)
        self._notify(now, action, later, cause)
        self._perform(action)

    # Requests

    def _drop_ended(self, *, mode_changed: bool) -> None:
        """Remove requests that ended with the mode change."""
        self._requests = {
            name: request
            for name, request in self._requests.items()
            if request.failing or not (mode_changed and request.end is ActionEnd.MODE_CHANGES)
        }

    def _collect(self, now: float) -> None:
        """Update the requests; a cleared condition ends its request, or keeps it until its end."""
        self._new_cause = None
        found = dict(self._checks.requests(self._intended))
        for name, request in found.items():
            before = self._requests.get(name)
            if before is not None:
                before.action, before.failing = request.action, True
                continue
            self._requests[name] = request
            self._begin(request, now)
        for name in [name for name in self._requests if name not in found]:
            if self._requests[name].end is ActionEnd.CONDITION_CLEARS:
                del self._requests[name]
            else:
                self._requests[name].failing = False

    def _begin(self, request: ActionRequest, now: float) -> None:
        """Start the delay of a new request."""
        delay = float(self._autopilot.vehicle.parameters["COM_FAIL_ACT_T"])
        delayed = request.delayed and request.takeover and delay > _NO_DELAY
        if delayed and request.action > Action.WARN and now >= self._hold_until:
            self._hold_until = now + delay
        if request.action is not Action.NONE:
            self._new_cause = request.cause
        if request.action >= Action.HOLD:
            self._taken_over = False

    def _end_delay(self) -> None:
        """End the delay if it can no longer be used."""
        if self._action > Action.HOLD or self._taken_over or not self._checks.can_run(modes.HOLD):
            self._hold_until = self._autopilot.now

    # Selection of the action

    def _select(self, now: float, *, chosen: bool) -> tuple[Action, Action, str]:
        """Return the action now, the action after the delay, and the cause."""
        urgent = max(
            self._requests.values(), key=lambda request: request.action, default=ActionRequest(Action.NONE)
        )
        action, later, cause = urgent.action, Action.NONE, urgent.cause
        may_take_over = all(request.takeover for request in self._requests.values() if request.action)
        if now < self._hold_until and not self._taken_over and may_take_over and action not in _NEVER_DELAYED:
            action, later = Action.HOLD, action
        self._taken_over = (
            may_take_over
            and action in AUTOMATIC_ACTIONS
            and (self._taken_over or (chosen and self._action > Action.WARN))
        )
        if self._taken_over:
            action, later = max(Action.WARN, self._checks.fallback_of(self._intended)), Action.NONE
        done = self._checks.available_action(action)
        if Action.RETURN in (done, later) and self._already_returns():
            return Action.WARN, Action.NONE, cause
        return done, later, cause if done is action else ""

    def _already_returns(self) -> bool:
        """Return whether the chosen mode brings the vehicle down anyway."""
        on_its_way = self._intended in (modes.LAND, modes.RETURN)
        return on_its_way and self._checks.can_run(self._intended)

    # Execution of the action

    def _perform(self, action: Action) -> None:
        """Execute an action."""
        autopilot = self._autopilot
        self._update_state(action)
        if action is Action.TERMINATE:
            autopilot.terminate()
        elif action is Action.DISARM:
            autopilot.disarm("failsafe")
        else:
            mode = self._intended if action in (Action.NONE, Action.WARN) else self._checks.mode_of(action)
            if autopilot.mode.number != mode:
                autopilot.enter(mode, "failsafe" if action > Action.WARN else "failsafe ended")
        self._actual = autopilot.mode.number

    def _update_state(self, action: Action) -> None:
        """Set the autopilot's active failsafes: those whose action is more than a warning."""
        self._action = action
        failsafes, acting = (
            self._autopilot.failsafes,
            {name for name, request in self._requests.items() if request.action},
        )
        failsafes -= {name for name in _CONDITIONS if name not in acting or action <= Action.WARN}
        if action > Action.WARN:
            failsafes |= acting
        if not self._autopilot.armed or self._autopilot.guided.stream_alive:
            failsafes.discard("offboard")

    # Status texts

    def _notify(self, now: float, action: Action, later: Action, cause: str) -> None:
        """Report a new action or request."""
        if action > self._action:
            self._report(action, later, cause, max(self._hold_until - now, 0.0))
        elif self._new_cause is not None:
            self._report(Action.WARN, Action.NONE, self._new_cause, 0.0)

    def _report(self, action: Action, later: Action, cause: str, delay: float) -> None:
        """Send the status texts of an action."""
        if action is Action.WARN:
            if cause:
                text = WARNINGS.get(cause, f"Failsafe warning: {cause}")
                self._send_statustext(
                    text, _SEVERITIES.get(cause, _CRITICAL if cause in WARNINGS else _WARNING)
                )
            return
        before = cause or "Failsafe activated"
        if action is Action.HOLD and later is not Action.NONE:
            self._send_statustext(f"{before}: switching to {ACTION_NAMES[later]} in {delay:.0f} seconds")
            self._send_statustext(f"Failsafe activated: entering Hold for {delay:.0f} seconds")
            return
        if not cause and action in _DISENGAGED:
            before += ": Autopilot disengaged, switching to " + ACTION_NAMES[action]
        else:
            before += ": switching to " + ACTION_NAMES[action]
        self._send_statustext(before)
        if action is not Action.TERMINATE:  # the profile sends a status text for every termination
            self._send_statustext("Failsafe activated")

    def _send_statustext(self, text: str, severity: int = _CRITICAL) -> None:
        """Send a status text."""
        self._autopilot.vehicle.send_statustext(text, severity)


#: Names in `SimulatedAutopilot.failsafes` that are conditions of failsafes.
_CONDITIONS: Final = frozenset(
    {"manual control", "ground station", "battery 1", "battery 2", "battery 3", "motor", "mode"}
)


def setpoints_lost(autopilot: SimulatedAutopilot) -> None:
    """Execute COM_OBL_RC_ACT after the setpoints of Offboard stopped."""
    autopilot.vehicle.send_statustext("Failsafe activated", _CRITICAL)
    autopilot.failsafes.add("offboard")
    action = int(autopilot.vehicle.parameters["COM_OBL_RC_ACT"])
    if action == _OFFBOARD_TERMINATE:
        autopilot.terminate()
    elif action == _OFFBOARD_DISARM:
        autopilot.disarm("failsafe")
    else:
        _enter_first(autopilot, _OFFBOARD_ACTIONS.get(action, modes.POSITION))


def _enter_first(autopilot: SimulatedAutopilot, preferred: int) -> None:
    """Enter the first mode that is possible."""
    for number in (preferred, *_OFFBOARD_FALLBACKS):
        mode = autopilot.find_mode(number)
        if mode is None or (mode.manual_control and not autopilot.radio.present):
            continue
        if autopilot.enter(number, SETPOINTS_LOST):
            return

"""Operations on a gimbal; all of them run on the `CommandClient` of the gimbal manager.

TakeControl    GIMBAL_MANAGER_STATUS ── free, ours or `force` ── DO_GIMBAL_MANAGER_CONFIGURE ──► result
                                      └── another component's ──► RemoteDenied
PointGimbal    DO_GIMBAL_MANAGER_PITCHYAW ── accepted ── GIMBAL_DEVICE_ATTITUDE_STATUS ── reached ──► result
                                                              └── no progress ──► ActionTimeout
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from mavstack.dialects import common
from mavstack.errors import ActionTimeout, CommandDenied, MessageTimeout, RemoteDenied, RemoteTimeout
from mavstack.services.addressing import Address, message_ids
from mavstack.services.command import Command, CommandOperation
from mavstack.services.gimbal.control import RELEASE, UNCHANGED
from mavstack.services.gimbal.reports import (
    ALL_DEVICES,
    MAX_ATTACHED_DEVICE,
    GimbalAttitude,
    GimbalInformation,
    GimbalStatus,
)
from mavstack.services.gimbal.rotation import wrap
from mavstack.services.message_request import ListInstances, RequestMessage
from mavstack.services.operation import Operation
from mavstack.services.procedure import Procedure

if TYPE_CHECKING:
    from collections.abc import Callable, Generator

    from mavstack.services.gimbal.setpoint import GimbalSetpoint

#: Degrees within which an angle counts as reached.
TOLERANCE = 1.0
#: Seconds without progress after which pointing fails.
STALL_TIMEOUT = 5.0
#: The smallest change of an angle that counts as progress, in degrees.
MIN_PROGRESS = 0.5
#: Timeout in seconds of the message that reports who is in control; a manager that does not send it has no
#: owner.
STATUS_TIMEOUT = 3.0
#: Timeout in seconds of the message with the names of a gimbal.
NAMES_TIMEOUT = 2.0


class ListGimbals(Procedure[tuple[GimbalInformation, ...]]):
    """The listing of the gimbals that a component manages (GIMBAL_MANAGER_INFORMATION for all devices)."""

    timeout_error = MessageTimeout

    def __init__(self, *, timeout: float | None = None) -> None:
        super().__init__("listing the gimbals of", timeout=timeout, idle_timeout=60.0)

    def steps(self) -> Generator[Operation[Any], Any, tuple[GimbalInformation, ...]]:
        try:
            found = yield ListInstances(
                common.GimbalManagerInformation, lambda message: int(message.gimbal_device_id)
            )
        except CommandDenied:
            return ()  # a component that denies the request manages no gimbals
        gimbals = {}
        for number, message in found.items():
            gimbals[number] = yield from _named(GimbalInformation.read(message))
        return tuple(gimbals.values())


def _named(gimbal: GimbalInformation) -> Generator[Operation[Any], Any, GimbalInformation]:
    """Add the names of a gimbal that is attached to its manager; another one tells them itself."""
    number = gimbal.device_id
    if number > MAX_ATTACHED_DEVICE:
        return gimbal
    try:
        message = yield RequestMessage(
            common.GimbalDeviceInformation,
            (float(number),),
            match=lambda message: message.gimbal_device_id == number,
            timeout=NAMES_TIMEOUT,
        )
    except (RemoteDenied, RemoteTimeout):
        return gimbal
    return replace(gimbal, vendor=message.vendor_name, model=message.model_name)


class TakeControl(Procedure[None]):
    """Taking control of a gimbal for the local component.

    Args:
        local: The local component.
        device_id: The gimbal device; 0 for all of the manager.
        secondary: Take secondary control, and leave primary control as it is.
        force: Take control from another component.
        timeout: Seconds for the whole operation; None sets no overall limit.
    """

    def __init__(
        self,
        local: Address,
        device_id: int = ALL_DEVICES,
        *,
        secondary: bool = False,
        force: bool = False,
        timeout: float | None = None,
    ) -> None:
        super().__init__("taking control of the gimbal of", timeout=timeout, idle_timeout=60.0)
        self._local, self._device_id = local, device_id
        self._secondary, self._force = secondary, force

    def steps(self) -> Generator[Operation[Any], Any, None]:
        if not self._force:
            yield from self._check_owner()
        kept = (float(UNCHANGED),) * 2
        # The ids of the sender are sent, which PX4 and ArduPilot accept; the placeholder for the sender is
        # only for missions.
        ours = float(self._local.system), float(self._local.component)
        params = (*kept, *ours) if self._secondary else (*ours, *kept)
        yield CommandOperation(_configure(params, self._device_id))

    def _check_owner(self) -> Generator[Operation[Any], Any, None]:
        try:
            message = yield RequestMessage(
                common.GimbalManagerStatus,
                (self._device_id,),
                match=lambda message: self._device_id in (ALL_DEVICES, message.gimbal_device_id),
                timeout=STATUS_TIMEOUT,
            )
        except (RemoteDenied, MessageTimeout):
            return  # the manager does not report who is in control
        status = GimbalStatus.read(message)
        owner = status.secondary if self._secondary else status.primary
        if owner is not None and owner != self._local:
            raise RemoteDenied(
                self.description,
                str(self.target),
                answer=f"component {owner} is in control; force takes it over",
                code=common.MavResult.DENIED,
            )


def release_control(device_id: int = ALL_DEVICES) -> Command:
    """Return the command that gives up the sender's control of a gimbal, primary and secondary."""
    return _configure((float(RELEASE),) * 4, device_id)


def assign_control(
    primary: Address | None, secondary: Address | None, device_id: int = ALL_DEVICES
) -> Command:
    """Return the command that assigns the control of a gimbal; None: no component."""
    none = Address(0, 0)
    params = (*map(float, primary or none), *map(float, secondary or none))
    return _configure(params, device_id)


class PointGimbal(Procedure["GimbalAttitude | None"]):
    """Pointing a gimbal, and waiting until it points there.

    Args:
        setpoint: The angles.
        device_id: The gimbal device; 0 for all of the manager.
        attitude: Returns the last attitude that was received.
        wait: Wait until the angles are reached.
        timeout: Seconds for the whole operation; None sets no overall limit.
    """

    timeout_error = ActionTimeout

    def __init__(
        self,
        setpoint: GimbalSetpoint,
        device_id: int,
        attitude: Callable[[], GimbalAttitude | None],
        *,
        wait: bool = True,
        timeout: float | None = None,
    ) -> None:
        super().__init__("pointing the gimbal of", timeout=timeout, idle_timeout=60.0)
        self._setpoint, self._device_id, self._wait = setpoint, device_id, wait
        self._attitude = attitude

    def steps(self) -> Generator[Operation[Any], Any, GimbalAttitude | None]:
        yield CommandOperation(self._setpoint.to_command(self._device_id))
        if self._wait:
            yield _Reach(self._remaining)
        return self._attitude()

    def _remaining(self) -> float | None:
        """Return the degrees that are left; None if the gimbal has not reported its attitude."""
        present, wanted = self._attitude(), self._setpoint
        if present is None:
            return None
        if wanted.retract or wanted.neutral:
            flag = common.GimbalDeviceFlags.RETRACT if wanted.retract else common.GimbalDeviceFlags.NEUTRAL
            rates = (present.pitch_rate or 0.0, present.yaw_rate or 0.0)
            return 0.0 if present.flags & flag and max(map(abs, rates)) < MIN_PROGRESS else 180.0
        yaw = present.heading if wanted.yaw_in_earth_frame else present.yaw
        pairs = [(wanted.pitch, present.pitch), (wanted.yaw, yaw)]
        ways = [abs(wrap(goal - angle)) for goal, angle in pairs if goal is not None and angle is not None]
        return max(ways, default=0.0)


class _Reach(Operation[None]):
    """The wait until a gimbal points where it shall; fails if it stops on the way."""

    timeout_error = ActionTimeout
    handles = message_ids(common.GimbalDeviceAttitudeStatus)
    INTERVAL = 0.1

    def __init__(self, remaining: Callable[[], float | None]) -> None:
        super().__init__("pointing the gimbal of", idle_timeout=STALL_TIMEOUT)
        self._remaining = remaining
        self._best: float | None = None

    def start(self, now: float) -> None:
        self.timer = now + self.INTERVAL

    def handle_timeout(self, now: float) -> None:
        left = self._remaining()
        self.timer = now + self.INTERVAL
        if left is not None and left <= TOLERANCE:
            self.finish(None)
        elif left is not None and (self._best is None or left < self._best - MIN_PROGRESS):
            self._best = left
            self.report_progress(now)

    def time_out(self, now: float, answer: str = "no answer") -> None:
        if self._best is None:
            answer = "accepted, but the gimbal does not report its attitude"
        else:
            answer = f"no progress for {STALL_TIMEOUT:g} s, {self._best:.0f} degrees to go"
        super().time_out(now, answer)


def _configure(params: tuple[float, ...], device_id: int) -> Command:
    return Command.of(common.MavCmd.DO_GIMBAL_MANAGER_CONFIGURE, (*params, 0.0, 0.0, float(device_id)))

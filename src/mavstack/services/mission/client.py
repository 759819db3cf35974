"""The asking side: plans up and down, and what the vehicle tells about the mission by itself."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from mavstack.dialects import common
from mavstack.services.addressing import Address, message_ids
from mavstack.services.mission.download import DownloadPlan
from mavstack.services.mission.manage import ClearPlan, SetCurrentItem
from mavstack.services.mission.plan import Plan, PlanType
from mavstack.services.mission.strays import Strays
from mavstack.services.mission.transfer import Transfer
from mavstack.services.mission.upload import UploadPlan
from mavstack.services.operation import AnyOperation, Client, Operation
from mavstack.services.service import Event
from mavstack.services.timing import RoundTrip

if TYPE_CHECKING:
    from mavstack.wire import Packet

#: For so long the vehicle's questions about a transfer that is over are answered.
MEMORY = 30.0

_Result = common.MavMissionResult


@dataclass(frozen=True, slots=True)
class MissionProgress(Event):
    """Where the vehicle is in its mission, when that changes; an id is 0 without a plan, or without ids."""

    seq: int
    total: int
    state: int
    mission_id: int
    fence_id: int
    rally_points_id: int

    @property
    def plan_ids(self) -> dict[int, int]:
        """The ids by type."""
        return {
            int(PlanType.MISSION): self.mission_id,
            int(PlanType.FENCE): self.fence_id,
            int(PlanType.RALLY): self.rally_points_id,
        }


@dataclass(frozen=True, slots=True)
class ItemReached(Event):
    """The vehicle reached an item of its mission."""

    seq: int


class MissionClient(Client):
    """Gives plans to one vehicle and gets them; `home_first`: its missions begin with its home."""

    handles = message_ids(
        common.MissionRequest,
        common.MissionRequestInt,
        common.MissionAck,
        common.MissionCount,
        common.MissionItem,
        common.MissionItemInt,
        common.MissionCurrent,
        common.MissionItemReached,
    )

    def __init__(self, local: Address, target: Address, *, home_first: bool = False) -> None:
        super().__init__(local, target)
        self.home_first = home_first
        #: What the vehicle last told about its mission.
        self.progress: MissionProgress | None = None
        self._reached: int | None = None
        self._round_trip = RoundTrip(initial=0.5, least=0.02, most=1.5)
        self._strays = Strays()
        self._last: dict[tuple[int, type], Transfer[Any]] = {}

    def upload(self, plan: Plan, now: float, *, timeout: float | None = None) -> UploadPlan:
        """Give the vehicle a plan in the place of its own; the result is the plan under the vehicle's id."""
        return self.begin(UploadPlan(plan, timeout=timeout, home_first=self.home_first), now)

    def download(
        self, now: float, plan_type: int = PlanType.MISSION, *, timeout: float | None = None
    ) -> DownloadPlan:
        """Get the plan that the vehicle holds."""
        return self.begin(DownloadPlan(plan_type, timeout=timeout), now)

    def clear(
        self, now: float, plan_type: int = PlanType.MISSION, *, timeout: float | None = None
    ) -> ClearPlan:
        """Let the vehicle forget its plan."""
        return self.begin(ClearPlan(plan_type, timeout=timeout), now)

    def set_current(self, seq: int, now: float, *, timeout: float | None = None) -> SetCurrentItem:
        """Let the mission go on at an item, the older way; see `set_current_item` for the command."""
        return self.begin(SetCurrentItem(seq, timeout=timeout), now)

    def forget_progress(self) -> None:
        """The vehicle started anew: where it is in its mission is to be told again."""
        self.progress = self._reached = None

    def still_held(self, plan: Plan) -> bool | None:
        """Whether the vehicle still holds a plan that it gave or was given; None if it does not tell."""
        told = self.progress.plan_ids.get(plan.type, 0) if self.progress else 0
        return None if not told or not plan.plan_id else told == plan.plan_id

    def begin(self, operation: AnyOperation, now: float) -> AnyOperation:
        if isinstance(operation, Transfer):
            operation.join(self._strays, self._round_trip)
            self._last[operation.type, type(operation)] = operation
        return super().begin(operation, now)

    def conflicts(self, new: Operation[Any], running: Operation[Any]) -> bool:
        return isinstance(new, Transfer) and isinstance(running, Transfer)

    def observe(self, packet: Packet, now: float) -> None:
        match packet.message:
            case common.MissionCurrent() as message:
                self._tell_progress(message)
            case common.MissionItemReached(seq=seq) if seq != self._reached:  # it is said several times
                self._reached = seq
                self.emit(ItemReached(seq))
            case common.MissionRequest(mission_type=kind) | common.MissionRequestInt(mission_type=kind):
                self._asked_for_item(int(kind), now)
            case common.MissionAck(type=_Result.OPERATION_CANCELLED, mission_type=kind):
                self._strays.stopped(int(kind))
            case common.MissionItemInt(mission_type=kind) | common.MissionItem(mission_type=kind):
                self._item_again(int(kind), now)

    def _tell_progress(self, message: common.MissionCurrent) -> None:
        progress = MissionProgress(
            message.seq,
            message.total,
            int(message.mission_state),
            message.mission_id,
            message.fence_id,
            message.rally_points_id,
        )
        if progress.seq == self._reached and progress.seq != (self.progress.seq if self.progress else None):
            self._reached = None  # the vehicle goes there again
        if progress != self.progress:
            self.progress = progress
            self.emit(progress)

    def _asked_for_item(self, plan_type: int, now: float) -> None:
        """An upload asks for its items by itself; if none goes on, the vehicle is in one that is over."""
        upload = self._last.get((plan_type, UploadPlan))
        if upload is not None and (upload.done or not upload.begun):
            self._strays.asked(plan_type, now)
            self._say_again(upload, _Result.OPERATION_CANCELLED, now)

    def _item_again(self, plan_type: int, now: float) -> None:
        """The vehicle did not hear that a download has ended."""
        download = self._last.get((plan_type, DownloadPlan))
        if download is not None and download.done and download.error is None:
            self._say_again(download, _Result.ACCEPTED, now)

    def _say_again(self, transfer: Transfer[Any], result: int, now: float) -> None:
        """Say how a transfer ended, unless one goes on that might be taken for it."""
        others = [other for other in self._running if isinstance(other, Transfer) and other.begun]
        disturbed = any(other.writes or other.type == transfer.type for other in others)
        remembered = not transfer.done or now - transfer.sent_at < MEMORY
        if remembered and not disturbed:
            transfer.acknowledge(result, now)

"""The mission protocol: missions, fences and rally points, up and down (guide: mission protocol)."""

from mavstack.services.mission.client import ItemReached, MissionClient, MissionProgress
from mavstack.services.mission.download import DownloadPlan
from mavstack.services.mission.item import MissionItem
from mavstack.services.mission.manage import ClearPlan, SetCurrentItem, set_current_item
from mavstack.services.mission.packed import PLAN_FILES, PlanFile, pack_plan, unpack_plan
from mavstack.services.mission.plan import PLAN_TYPES, Plan, PlanStore, PlanType
from mavstack.services.mission.server import CurrentItemSet, MissionServer, MissionServerOptions, PlanReplaced
from mavstack.services.mission.upload import UploadPlan

__all__ = [
    "PLAN_FILES",
    "PLAN_TYPES",
    "ClearPlan",
    "CurrentItemSet",
    "DownloadPlan",
    "ItemReached",
    "MissionClient",
    "MissionItem",
    "MissionProgress",
    "MissionServer",
    "MissionServerOptions",
    "Plan",
    "PlanFile",
    "PlanReplaced",
    "PlanStore",
    "PlanType",
    "SetCurrentItem",
    "UploadPlan",
    "pack_plan",
    "set_current_item",
    "unpack_plan",
]

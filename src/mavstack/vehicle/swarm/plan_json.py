"""Plans of surveys and searches as JSON, for the command line and the API of the station."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from mavstack.files.plans.mavstack_json import item_json
from mavstack.swarm.search.surveys import to_degrees

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.geodesy import LocalFrame
    from mavstack.swarm.search.plans import Share
    from mavstack.swarm.search.surveys import Survey, SurveyPlan


def survey_json(
    plan: SurveyPlan, survey: Survey, systems: Sequence[int | None], speeds: Sequence[float]
) -> dict[str, Any]:
    """Return the plan of a survey as JSON.

    Args:
        plan: The plan.
        survey: How the area is surveyed.
        systems: The system id of each vehicle; None: it is not known.
        speeds: The speed of each vehicle in m/s.
    """
    camera, altitude = survey.camera, survey.mission.altitude
    pixel = None if camera is None else camera.pixel_size(altitude)
    return {
        "spacing_m": round(plan.spacing, 3),
        "bearing_deg": None if plan.bearing is None else round(plan.bearing % 180.0, 3),
        "area_m2": round(plan.size, 1),
        "footprint_m": None if camera is None else [round(each, 3) for each in camera.footprint(altitude)],
        "trigger_distance_m": round(survey.mission_options.trigger_distance, 3),
        "pixel_m": None if pixel is None else round(pixel, 5),
        "shares": [
            share_json(share, plan.frame, system, speed)
            for share, system, speed in zip(plan.shares, systems, speeds, strict=True)
        ],
    }


def share_json(share: Share, frame: LocalFrame, system: int | None, speed: float) -> dict[str, Any]:
    """Return the share of a vehicle as JSON.

    Args:
        share: The share.
        frame: The frame of its legs.
        system: The system id of the vehicle; None: it is not known.
        speed: Ground speed in m/s, for the duration.
    """
    return {
        "system": system,
        "altitude_m": share.altitude,
        "length_m": round(share.length, 1),
        "way_m": round(share.way, 1),
        "speed_m_s": speed,
        "duration_s": round(share.way / speed, 1),
        "legs": [[_place(frame, track.start), _place(frame, track.end)] for track in share.tracks],
        "items": [item_json(seq, item) for seq, item in enumerate(share.items)],
    }


def _place(frame: LocalFrame, corner: tuple[float, float]) -> list[float]:
    """Return a corner in degrees; nine digits are a tenth of a millimetre."""
    return [round(each, 9) for each in to_degrees(frame, corner)]

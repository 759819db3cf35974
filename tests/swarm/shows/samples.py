"""Shows of tests: circles around a centre, as files of Skybrush Studio and of Blender."""

from __future__ import annotations

import base64
import io
import json
import math
import zipfile
from typing import Any

LIGHTS = bytes((0x04, 255, 0, 0, 50, 0x04, 0, 0, 255, 50, 0x00))


def place(index, count, radius, share):
    angle = 2.0 * math.pi * (index / count + share)
    return [radius * math.cos(angle), radius * math.sin(angle)]


def points_of(index, count, *, radius=15.0, height=10.0, seconds=60.0):
    """The points of a vehicle: up, a quarter of a circle as cubic curves, down."""
    start = place(index, count, radius, 0.0)
    points: list[list[Any]] = [
        [0.0, [*start, 0.0], []],
        [10.0, [*start, height], [[*start, 0.0], [*start, height]]],
    ]
    parts = 3
    for part in range(1, parts + 1):
        first = place(index, count, radius, (part - 1) / parts / 4)
        last = place(index, count, radius, part / parts / 4)
        arc = 2.0 * math.pi / 4 / parts
        reach = 4.0 / 3.0 * math.tan(arc / 4.0)
        controls = [
            [first[0] - reach * first[1], first[1] + reach * first[0], height],
            [last[0] + reach * last[1], last[1] - reach * last[0], height],
        ]
        points.append([10.0 + part / parts * (seconds - 20.0), [*last, height], controls])
    end = points[-1][1][:2]
    points.append([seconds, [*end, 0.0], [[*end, height], [*end, 0.0]]])
    return points


def skyc(count=4, *, references=True, **options):
    """The content of a .skyc file."""
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w") as archive:
        drones = []
        for index in range(count):
            trajectory = {"points": points_of(index, count, **options), "takeoffTime": 0.0, "version": 1}
            lights = {"data": base64.b64encode(LIGHTS).decode(), "version": 1}
            if references:
                archive.writestr(f"drones/{index}/trajectory.json", json.dumps(trajectory))
                trajectory = {"$ref": f"./drones/{index}/trajectory.json#"}
            settings = {"name": f"Drone {index + 1}", "trajectory": trajectory, "lights": lights}
            drones.append({"type": "generic", "settings": settings})
        show = {"version": 1, "meta": {"title": "Circle"}, "swarm": {"drones": drones}}
        archive.writestr("show.json", json.dumps(show))
    return data.getvalue()


def table(index, count, *, radius=15.0):
    lines = ["Time [msec],x [m],y [m],z [m],Red,Green,Blue"]
    for step in range(81):
        x, y = place(index, count, radius, 0.0)
        z = min(step, 20, 80 - step) * 0.4
        lines.append(f"{step * 250},{x:.3f},{y:.3f},{z:.3f},{255 if step < 40 else 0},0,{step // 40 * 100}")
    return "\n".join(lines) + "\n"


def csv_archive(count=3):
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w") as archive:
        for index in range(count):
            archive.writestr(f"show/Drone {index + 1}.csv", table(index, count))
    return data.getvalue()

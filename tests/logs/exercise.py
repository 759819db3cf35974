"""Everything that a log can be asked, for logs that define known tables in unexpected ways."""

from __future__ import annotations

import json
import math
from contextlib import suppress

from mavstack.errors import LogError
from mavstack.logs.compare import last_parameters, mission_of
from mavstack.logs.export import export_log
from mavstack.logs.gps_fixes import gps_fixes
from mavstack.logs.report import make_report


def exercise(log, folder):
    """Use all of a log; only a `LogError` may be raised, where the log does not hold what is asked for."""
    log.load()
    assert log.start is None or log.end is not None
    assert math.isfinite(log.duration)
    assert log.info is not None
    assert log.parameters.keys() >= {change.name for change in log.parameter_changes}
    assert log.vehicles
    assert log.skipped.describe()
    assert log.time_base.describe()
    list(log.texts)
    list(log.records())
    dict(log.select(start=0.0, end=1.0).counts)
    mission_of(log)
    last_parameters(log)
    gps_fixes(log, "auto")
    for name in log:
        json.dumps(log.schema(name).to_dict())
        log[name].to_arrow("lists", scaled=True, enums=True)
    json.dumps(make_report(log).data, allow_nan=False)
    for name in ("csv", "mcap", "mat"):
        export_log(log, name, folder / f"out.{name}")
    for name in ("geojson", "kml"):
        with suppress(LogError):  # without positions
            export_log(log, name, folder / f"out.{name}")
    if (folder / "out.geojson").exists():
        json.loads((folder / "out.geojson").read_text("utf-8"), parse_constant=_refuse)


def _refuse(constant):
    raise AssertionError(f"{constant} is no JSON")

"""KML, GPX and GeoJSON: the tracks of the vehicles, for maps."""

from __future__ import annotations

import json
from collections import Counter
from typing import TYPE_CHECKING, Final
from xml.sax.saxutils import escape

import numpy as np

from mavstack.errors import LogError
from mavstack.logs.export.registry import LogExporter
from mavstack.logs.export.writer import ExportOptions, ExportWriter, PartFile, counted, nothing_to_write
from mavstack.logs.tracks import tracks

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from pathlib import Path
    from typing import Any

    from mavstack.logs.export.writer import Progress
    from mavstack.logs.log import Log
    from mavstack.logs.tracks import Track

#: Decimals of degrees, which resolve one centimetre.
_DEGREE_DIGITS: Final = 7


class TrackWriter(ExportWriter):
    """Writes the tracks of a log into one file; no other table is decoded."""

    def __init__(
        self, log: Log, path: Path, options: ExportOptions, render: Callable[[Log, Sequence[Track]], str]
    ) -> None:
        super().__init__(log, path, options)
        self._render = render
        self._file = PartFile(path)
        self._tracks: list[Track] = []

    def write_log(self, names: Sequence[str], progress: Progress) -> Mapping[str, int]:
        """Find the tracks; see `ExportWriter.write_log`."""
        self._tracks = tracks(self.log.select(*names) if names else self.log)
        if not self.log:
            raise nothing_to_write(self.log)
        if not self._tracks:
            raise LogError(f"{self.log.path}: it holds no position")
        if progress is not None:
            progress(self.log.size, self.log.size)
        points: Counter[str] = Counter()
        for track in self._tracks:
            points[track.source] += len(track)
        return points

    def describe(self, rows: Mapping[str, int]) -> str:
        """Return the number of points and of vehicles; see `ExportWriter.describe`."""
        return f"{counted(sum(rows.values()), 'point')} of {counted(len(self._tracks), 'vehicle')}"

    def finish(self) -> list[Path]:
        """Write the file; see `ExportWriter.finish`."""
        self._file.temporary.write_text(self._render(self.log, self._tracks), "utf-8")
        return [self._file.complete()]

    def discard(self) -> None:
        """Remove an incomplete file; see `ExportWriter.discard`."""
        self._file.discard()


def kml(log: Log, found: Sequence[Track]) -> str:
    """Return tracks as KML, which Google Earth shows with altitudes and a time slider."""
    places = "\n".join(_kml_track(log, track) for track in found)
    return (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        '<kml xmlns="http://www.opengis.net/kml/2.2" xmlns:gx="http://www.google.com/kml/ext/2.2">\n'
        f"<Document>\n<name>{escape(log.path.name)}</name>\n{places}\n</Document>\n</kml>\n"
    )


def _kml_track(log: Log, track: Track) -> str:
    times = _utc_texts(log, track)
    whens = "".join(f"<when>{time}</when>\n" for time in times)
    points = "\n".join(
        f"<gx:coord>{longitude} {latitude} {altitude}</gx:coord>"
        for longitude, latitude, altitude in _points(track)
    )
    line = f"<gx:Track><altitudeMode>absolute</altitudeMode>\n{whens}{points}\n</gx:Track>"
    if not times:
        coordinates = " ".join(",".join(map(str, point)) for point in _points(track))
        line = (
            "<LineString><altitudeMode>absolute</altitudeMode>"
            f"<coordinates>{coordinates}</coordinates></LineString>"
        )
    style = "<Style><LineStyle><color>ff0080ff</color><width>3</width></LineStyle></Style>"
    return f"<Placemark><name>{_title(track)}</name>{style}\n{line}\n</Placemark>"


def gpx(log: Log, found: Sequence[Track]) -> str:
    """Return tracks as GPX 1.1."""
    segments = "\n".join(_gpx_track(log, track) for track in found)
    return (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        '<gpx version="1.1" creator="mavstack" xmlns="http://www.topografix.com/GPX/1/1">\n'
        f"{segments}\n</gpx>\n"
    )


def _gpx_track(log: Log, track: Track) -> str:
    times = _utc_texts(log, track) or [""] * len(track)
    points = "\n".join(
        f'<trkpt lat="{latitude}" lon="{longitude}"><ele>{altitude}</ele>'
        + (f"<time>{time}</time>" if time else "")
        + "</trkpt>"
        for (longitude, latitude, altitude), time in zip(_points(track), times, strict=True)
    )
    return f"<trk><name>{_title(track)}</name><trkseg>\n{points}\n</trkseg></trk>"


def geojson(log: Log, found: Sequence[Track]) -> str:
    """Return tracks as GeoJSON, a LineString for each vehicle with the times in `coordTimes`."""
    features = [_feature(log, track) for track in found]
    return json.dumps({"type": "FeatureCollection", "features": features}) + "\n"


def _feature(log: Log, track: Track) -> dict[str, Any]:
    points = _points(track)
    many = len(points) > 1
    properties: dict[str, Any] = {
        "name": _title(track),
        "system": track.system,
        "source": track.source,
        "file": log.path.name,
    }
    if times := _utc_texts(log, track):
        properties["coordTimes"] = times if many else times[0]
    geometry = {"type": "LineString" if many else "Point", "coordinates": points if many else points[0]}
    return {"type": "Feature", "properties": properties, "geometry": geometry}


def _title(track: Track) -> str:
    return f"vehicle {track.system}" if track.system else "vehicle"


def _points(track: Track) -> list[list[float]]:
    """Return longitude, latitude, altitude of each point."""
    columns = (
        track.longitudes.round(_DEGREE_DIGITS),
        track.latitudes.round(_DEGREE_DIGITS),
        track.altitudes.round(2),
    )
    points: list[list[float]] = np.column_stack(columns).tolist()
    return points


def _utc_texts(log: Log, track: Track) -> list[str]:
    """Return the times as ISO 8601, or nothing if the log does not hold UTC."""
    if log.time_base.kind == "boot":
        return []
    times = (track.times * 1e3).round().astype("M8[ms]")
    return [f"{time}Z" for time in times]


def _exporter(name: str, description: str, render: Callable[[Log, Sequence[Track]], str]) -> LogExporter:
    def open_writer(log: Log, path: Path, options: ExportOptions) -> TrackWriter:
        return TrackWriter(log, path, options, render)

    return LogExporter(name, description, f".{name}", False, open_writer)


KML: Final = _exporter("kml", "tracks for Google Earth", kml)
GPX: Final = _exporter("gpx", "tracks for navigation programs", gpx)
GEOJSON: Final = _exporter("geojson", "tracks for web maps and GIS", geojson)

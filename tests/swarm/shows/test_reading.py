"""Show files, sound and damaged."""

from __future__ import annotations

import io
import json
import random
import zipfile

import numpy as np
import pytest

from mavstack.errors import PlanFileError
from mavstack.swarm.shows.reading import parse_show
from tests.swarm.shows.samples import LIGHTS, csv_archive, skyc, table


@pytest.mark.parametrize("references", [True, False])
def test_a_skyc_file_is_read(references):
    show = parse_show(skyc(5, references=references), "circle.skyc")
    assert (show.name, len(show.vehicles), show.duration) == ("Circle", 5, 60.0)
    assert show.vehicles[2].name == "Drone 3"
    assert show.vehicles[2].lights == LIGHTS
    radii = np.hypot(*show.positions(35.0)[:, :2].T)
    assert radii == pytest.approx([15.0] * 5, abs=0.01)  # cubic curves are nearly arcs
    assert show.positions(5.0)[:, 2] == pytest.approx([5.0] * 5)


def test_tables_are_read():
    show = parse_show(csv_archive(3), "show.zip")
    assert [each.name for each in show.vehicles] == ["Drone 1", "Drone 2", "Drone 3"]
    assert show.positions(2.5)[:, 2] == pytest.approx([4.0] * 3)
    assert show.vehicles[0].lights == bytes(
        (4, 255, 0, 0, 0xF4, 3, 4, 0, 0, 100, 0xF4, 3, 4, 0, 0, 200, 0, 0)
    )
    assert len(parse_show(table(0, 1).encode(), "one.csv").vehicles) == 1


def archive(**entries):
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w") as made:
        for name, text in entries.items():
            made.writestr(name.replace("_json", ".json"), text)
    return data.getvalue()


def shown(*points, **trajectory):
    settings = {"trajectory": {"points": list(points), **trajectory}}
    return archive(show_json=json.dumps({"swarm": {"drones": [{"settings": settings}]}}))


DAMAGED = [
    (b"", "not a table"),
    (b"a,b\n1,2\n", "its columns are not"),
    (b"PK\x03\x04", "not a ZIP archive"),
    (archive(other="x"), "neither show.json nor CSV"),
    (archive(show_json="{"), "show.json is not JSON"),
    (archive(show_json="{}"), "swarm is missing"),
    (archive(show_json='{"swarm": {"drones": []}}'), "0 vehicles"),
    (archive(show_json='{"swarm": {"drones": [{}]}}'), "settings is missing"),
    (archive(show_json='{"swarm": {"drones": [{"$ref": "./x"}]}}'), "no entry x"),
    (
        archive(
            show_json='{"swarm": {"drones": [{"$ref": "./loop.json"}]}}', loop_json='{"$ref": "./loop.json"}'
        ),
        "nested too deeply",
    ),
    (shown([0, [0, 0, 0], []], [-1, [0, 0, 1], []]), "not in order"),
    (shown([0, [0, 0], []], [1, [0, 0, 1], []]), "unpack"),
    (shown([0, [0, 0, 0], []], [1, [0, 0, 1], [[0, 0, 0]] * 9]), "2 to 8 points"),
    (shown([0, [0, 0, 0], []], [1, [0, 0, 1e9], []]), "at most"),
    (shown([0, [0, 0, 0], []], [1e9, [0, 0, 1], []]), "within four hours"),
]


@pytest.mark.parametrize(("data", "problem"), DAMAGED, ids=[problem for _, problem in DAMAGED])
def test_damaged_files_are_refused(data, problem):
    with pytest.raises(PlanFileError, match=problem):
        parse_show(data, "show.skyc")


def test_random_damage_is_an_error_or_a_show():
    sound = skyc(2)
    for seed in range(150):
        random.seed(seed)
        data = bytearray(sound)
        for _ in range(random.randint(1, 8)):
            data[random.randrange(len(data))] = random.randrange(256)
        try:
            parse_show(bytes(data), "show.skyc")
        except PlanFileError:
            continue

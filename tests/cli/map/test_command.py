"""`mav map`, with a web server of tiles on this machine."""

from __future__ import annotations

import json

import pytest

from mavstack.cli.main import main
from mavstack.cli.map.command import EXAMPLES
from mavstack.maps import Area, count_tiles
from tests.cli.harness import examples_of
from tests.maps.tile_pages import tile_pages

AREA = "47.39,8.53,47.41,8.56"
COUNT = count_tiles(Area.parse(AREA), range(12, 15))


@pytest.fixture
def pages():
    with tile_pages() as server:
        yield server


@pytest.fixture(autouse=True)
def home(monkeypatch, tmp_path):
    for name in ("HOME", "XDG_DATA_HOME", "LOCALAPPDATA"):
        monkeypatch.setenv(name, str(tmp_path))


def mav(capsys, *words, code=0):
    """Run a command, and return its output."""
    assert main(list(words)) == code, capsys.readouterr().err
    return capsys.readouterr()


def download(capsys, pages, *words, **options):
    place = ("--area", AREA, "--zoom", "12-14", "--rate", "200")
    return mav(capsys, "map", "download", pages.template, *place, *words, **options)


def test_a_map_is_estimated_downloaded_continued_and_removed(capsys, pages):
    dry = download(capsys, pages, "--dry-run")
    assert dry.out.startswith(f"{COUNT} tiles; about ")
    assert dry.err == "mav map: the server is on this machine\n"
    assert mav(capsys, "map", "list").out.endswith("has no maps; mav map download makes one\n")
    values = json.loads(download(capsys, pages, "--dry-run", "--json").out)
    assert (values["tiles"], values["missing"]) == (COUNT, COUNT)
    first = download(capsys, pages, "--name", "field", "--attribution", "© us").out
    assert f"field.mbtiles: {COUNT} tiles added" in first
    again = json.loads(download(capsys, pages, "--name", "field", "--json").out)
    assert (again["added"], again["present"]) == (0, COUNT)
    assert f"field  pictures (png)  zoom 12-14  {COUNT} tiles" in mav(capsys, "map", "list").out
    shown = json.loads(mav(capsys, "map", "info", "field", "--json").out)
    assert (shown["name"], shown["attribution"], shown["tiles"]) == ("field", "© us", COUNT)
    assert shown["area"] == {"south": 47.39, "west": 8.53, "north": 47.41, "east": 8.56}
    text = mav(capsys, "map", "info", again["file"]).out
    assert f"area         {AREA}\n" in text
    assert "add --yes to remove a map" in mav(capsys, "map", "remove", "field", code=2).err
    mav(capsys, "map", "remove", "field", "--yes")
    assert json.loads(mav(capsys, "map", "list", "--json").out) == []
    assert "there is no such file" in mav(capsys, "map", "remove", "field", code=1).err


def test_heights_into_a_file(capsys, pages, tmp_path):
    file = tmp_path / "heights.mbtiles"
    download(capsys, pages, "--terrain", "terrarium", "--file", str(file))
    assert "heights (terrarium)" in mav(capsys, "map", "info", str(file)).out


def test_every_example(capsys, pages, tmp_path):
    more = {"download": ["--zoom", "12-13", "--rate", "200"], "remove": ["--yes"]}
    for example in examples_of(EXAMPLES):
        words = [pages.template if "{z}" in word else word for word in example[example[0] == "mav" :]]
        mav(capsys, *words, *more.get(words[1], []))


@pytest.mark.parametrize(
    ("words", "problem"),
    [
        (["https://a/{z}/{x}.png", "--area", AREA], "the address of the tiles has no {y}"),
        (["https://a/{z}/{x}/{y}.png", "--area", "1,2,3"], "an area is four numbers of degrees"),
        (["https://a/{z}/{x}/{y}.png", "--around", "1,2"], "--around is LAT,LON,METRES"),
        (["https://a/{z}/{x}/{y}.png", "--area", AREA, "--zoom", "30"], "zoom levels are from 0 to 22"),
        (["https://a/{z}/{x}/{y}.png", "--area", AREA, "--name", "../x"], "names of maps"),
        (["https://a/{z}/{x}/{y}.png", "--area", AREA, "--rate", "0"], "the rate must be above 0"),
        (["https://a/{z}/{x}/{y}.png", "--area", "-80,-180,80,180"], "more than 500,000"),
    ],
    ids=["address", "area", "around", "zoom", "name", "rate", "count"],
)  # fmt: skip
def test_wrong_usage(capsys, words, problem):
    assert problem in mav(capsys, "map", "download", *words, code=2).err


def test_servers_that_forbid_it(capsys):
    url = "https://tile.openstreetmap.org/{z}/{x}/{y}.png"
    error = mav(capsys, "map", "download", url, "--area", AREA, code=1).err
    assert error.startswith("mav map: downloading tiles from tile.openstreetmap.org failed: ")
    assert error.count("\n") == 1

from __future__ import annotations

from io import BytesIO
from zipfile import ZipFile

import pytest

from tests.server.stations import Ground, serve

DEFINITION = b"""<mavlink><include>%s</include><version>3</version><messages>
<message id="180" name="MY_VALUE"><description>A value.</description>
<field type="uint8_t" name="value">The value.</field></message></messages></mavlink>"""


def test_languages_and_dialects_are_listed() -> None:
    async def scenario(ground: Ground) -> None:
        listed = (await ground.api.get("/api/generator")).json
        assert {"name": "c", "title": "C99"} in listed["languages"]
        assert "ardupilotmega" in listed["dialects"]

    serve((), scenario)


def test_libraries_are_a_zip_file() -> None:
    async def scenario(ground: Ground) -> None:
        query = "dialect=minimal&languages=c,lua&only=HEARTBEAT"
        answer = await ground.api.post(f"/api/generator?{query}")
        assert (answer.status, answer.headers["content-type"]) == (200, "application/zip")
        names = ZipFile(BytesIO(answer.data)).namelist()
        assert any(name.startswith("mavlink/c/") for name in names)
        assert any(name.startswith("mavlink/lua/") for name in names)

    serve((), scenario)


def test_a_definition_file_may_be_sent() -> None:
    async def scenario(ground: Ground) -> None:
        options = {"headers": {"content-type": "application/octet-stream"}}
        answer = await ground.api.post(
            "/api/generator?languages=c&only=MY_VALUE&file=own.xml",
            data=DEFINITION % b"minimal.xml",
            **options,
        )
        assert answer.status == 200, answer.data
        names = ZipFile(BytesIO(answer.data)).namelist()
        assert any("my_value" in name for name in names)
        assert any("own" in name for name in names), names
        for include in (b"/etc/passwd", b"../custom.xml"):
            refused = await ground.api.post(
                "/api/generator?languages=c", data=DEFINITION % include, **options
            )
            assert (refused.status, "official definitions" in refused.problem) == (400, True)
        broken = await ground.api.post("/api/generator?languages=c", data=b"<mavlink>", **options)
        assert broken.status == 400
        assert "/tmp" not in broken.problem

    serve((), scenario)


@pytest.mark.parametrize(
    ("query", "entry"), [("languages=", "languages"), ("languages=c&only=NO_SUCH", "only")]
)
def test_problems_of_each_entry(query: str, entry: str) -> None:
    async def scenario(ground: Ground) -> None:
        checked = (await ground.api.post(f"/api/generator/check?{query}")).json
        assert list(checked["problems"]) == [entry]
        assert checked["commands"] == []
        assert (await ground.api.post(f"/api/generator?{query}")).status == 400

    serve((), scenario)


def test_the_commands_that_do_the_same() -> None:
    async def scenario(ground: Ground) -> None:
        checked = (await ground.api.post("/api/generator/check?languages=c&package=x")).json
        assert checked == {"problems": {}, "commands": ["mav gen c common -o mavlink --package=x"]}
        assert (await ground.api.post("/api/generator/check?dialect=/etc/passwd")).status == 400
        place = "/api/generator/check?dialect=common&languages=c,go&file="
        own = await ground.api.post(f"{place}my%20ship.xml", data=DEFINITION % b"minimal.xml")
        assert own.json["commands"] == [
            f"mav gen {language} 'my ship.xml' -o mavlink/{language}" for language in ("c", "go")
        ]
        for name in ("../own.xml", "/tmp/own.xml", ".own.xml", "own", "%00.xml"):
            refused = await ground.api.post(place + name, data=DEFINITION % b"minimal.xml")
            assert (refused.status, refused.problem.startswith("file must be a string")) == (400, True)

    serve((), scenario)

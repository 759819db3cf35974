"""The generator of libraries in other languages, as the form of `mav gen --ui` offers it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from starlette.responses import Response

from mavstack.codegen import language, language_names
from mavstack.dialects.tables import official_names
from mavstack.http.bodies import RefusedError
from mavstack.security.roles import Role
from mavstack.server.api_route import ApiRoute, Call
from mavstack.server.fields import Field
from mavstack.server.generator.work import Work

if TYPE_CHECKING:
    from mavstack.server.generator.runner import Generated

#: Bytes of an uploaded definition file.
MAX_DEFINITION: Final = 4 << 20
_FOLDER: Final = "mavlink"
_DEFINITION: Final = "custom.xml"
#: A name without a folder, and none of a hidden file.
_FILE_NAME: Final = r"[A-Za-z0-9_][A-Za-z0-9_ .-]{0,99}\.xml"
_QUERY: Final = (
    Field(
        name="dialect",
        type="string",
        about="An official dialect; without meaning if the body is a definition file.",
        default="common",
        example="common",
    ),
    Field(
        name="file",
        type="string",
        about="The name of the definition file in the body, after which libraries are named.",
        default=_DEFINITION,
        pattern=_FILE_NAME,
        example="my_dialect.xml",
    ),
    Field(
        name="languages",
        type="string",
        about="Names of languages with commas.",
        default="",
        example="typescript",
    ),
    Field(
        name="only",
        type="string",
        about="Names and patterns of the messages, with commas; empty: all.",
        default="",
        example="HEARTBEAT,GPS*",
    ),
    Field(name="exclude", type="string", about="Messages to leave out, with commas.", default=""),
    Field(
        name="package",
        type="string",
        about="The package, module or namespace; empty: the default.",
        default="",
    ),
)


async def _show(_call: Call) -> dict[str, Any]:
    languages = [{"name": name, "title": language(name).title} for name in language_names()]
    return {"languages": languages, "dialects": list(official_names())}


async def _check(call: Call) -> dict[str, Any]:
    found = await _run(call, archive=False)
    return {"problems": found.problems, "commands": found.commands}


async def _generate(call: Call) -> Response:
    data = (await _run(call, archive=True)).archive
    headers = {"Content-Disposition": f'attachment; filename="{_FOLDER}.zip"'}
    return Response(data, media_type="application/zip", headers=headers)


async def _run(call: Call, *, archive: bool) -> Generated:
    """Run the generator for a request."""
    query, dialect = call.query, call.query["dialect"]
    if not call.data and dialect not in official_names():  # a path would name a file of the server
        raise RefusedError(400, f"there is no official dialect {dialect[:60]!r}")
    options = {key: query[key] for key in ("only", "exclude", "package")}
    chosen = [word.strip() for word in query["languages"].split(",") if word.strip()]
    work = Work(
        dialect=dialect,
        file=query["file"] if call.data else "",
        languages=list(dict.fromkeys(chosen)),
        folder=_FOLDER,
        options=options,
        archive=archive,
    )
    return await call.station.generator.run(work, call.data)


ROUTES: Final = (
    ApiRoute(
        method="GET",
        path="/api/generator",
        handler=_show,
        summary="List the languages and dialects for which libraries are generated",
        tag="generator",
        answer={"languages": [{"name": "c", "title": "C99"}], "dialects": ["common"]},
    ),
    ApiRoute(
        method="POST",
        path="/api/generator/check",
        handler=_check,
        summary="Check the entries of the form: the problem of each, and the commands that do the same",
        tag="generator",
        role=Role.OPERATE,
        query=_QUERY,
        takes_bytes=True,
        has_body=False,
        max_body=MAX_DEFINITION,
        answer={"problems": {}, "commands": ["mav gen c common -o mavlink"]},
    ),
    ApiRoute(
        method="POST",
        path="/api/generator",
        handler=_generate,
        summary="Generate libraries, as a ZIP file; the body is a definition file, or empty",
        tag="generator",
        role=Role.OPERATE,
        query=_QUERY,
        takes_bytes=True,
        has_body=False,
        max_body=MAX_DEFINITION,
        is_long=True,
        media_type="application/zip",
    ),
)

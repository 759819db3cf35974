"""The generator of libraries in other languages, as the form of `mav gen --ui` offers it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, Final

from msgspec import Meta
from starlette.responses import Response

from mavstack.codegen import language, language_names
from mavstack.dialects.tables import official_names
from mavstack.http.bodies import RefusedError
from mavstack.http.request_fields import Fields
from mavstack.http.routes import RouteTable, WaitField
from mavstack.security.roles import Role
from mavstack.server.api_route import AnyRoute, ApiRoute, Call, PlainCall
from mavstack.server.generator.work import Work
from mavstack.server.request_types import MAX_TEXT, Text

if TYPE_CHECKING:
    from mavstack.server.generator.runner import Generated

#: Maximum size of an uploaded definition file in bytes.
MAX_DEFINITION: Final = 4 << 20
_FOLDER: Final = "mavlink"
_DEFINITION: Final = "custom.xml"
#: The name of a file: without a folder, and not hidden.
_FILE_NAME: Final = r"^[A-Za-z0-9_][A-Za-z0-9_ .-]{0,99}\.xml$(?!\n)"


class Form(Fields):
    """The entries of the form of the generator."""

    dialect: Annotated[
        Text,
        Meta(
            description="An official dialect; without meaning if the body is a definition file.",
            examples=["common"],
        ),
    ] = "common"
    file: Annotated[
        Annotated[str, Meta(max_length=MAX_TEXT, pattern=_FILE_NAME)],
        Meta(
            description="The name of the definition file in the body, after which libraries are named.",
            examples=["my_dialect.xml"],
        ),
    ] = _DEFINITION
    languages: Annotated[
        Text, Meta(description="Names of languages with commas.", examples=["typescript"])
    ] = ""
    only: Annotated[
        Text,
        Meta(
            description="Names and patterns of the messages, with commas; empty: all.",
            examples=["HEARTBEAT,GPS*"],
        ),
    ] = ""
    exclude: Annotated[Text, Meta(description="Messages to leave out, with commas.")] = ""
    package: Annotated[Text, Meta(description="The package, module or namespace; empty: the default.")] = ""


class GeneratorQuery(Form):
    """The form, of which libraries are made."""

    wait: WaitField = True


ROUTES: Final[RouteTable[AnyRoute]] = RouteTable(ApiRoute, "generator")


@ROUTES.add(
    "GET",
    "/api/generator",
    "List the languages and dialects for which libraries are generated",
    answer={"languages": [{"name": "c", "title": "C99"}], "dialects": ["common"]},
)
async def _show(_call: PlainCall) -> dict[str, Any]:
    languages = [{"name": name, "title": language(name).title} for name in language_names()]
    return {"languages": languages, "dialects": list(official_names())}


@ROUTES.add(
    "POST",
    "/api/generator/check",
    "Check the entries of the form: the problem of each, and the commands that do the same",
    role=Role.OPERATE,
    takes_bytes=True,
    has_body=False,
    max_body=MAX_DEFINITION,
    answer={"problems": {}, "commands": ["mav gen c common -o mavlink"]},
)
async def _check(call: Call[None, Form]) -> dict[str, Any]:
    found = await _run(call, archive=False)
    return {"problems": found.problems, "commands": found.commands}


@ROUTES.add(
    "POST",
    "/api/generator",
    "Generate libraries, as a ZIP file; the body is a definition file, or empty",
    role=Role.OPERATE,
    takes_bytes=True,
    has_body=False,
    max_body=MAX_DEFINITION,
    media_type="application/zip",
)
async def _generate(call: Call[None, GeneratorQuery]) -> Response:
    data = (await _run(call, archive=True)).archive
    headers = {"Content-Disposition": f'attachment; filename="{_FOLDER}.zip"'}
    return Response(data, media_type="application/zip", headers=headers)


async def _run(call: Call[Any, Any], *, archive: bool) -> Generated:
    """Run the generator for a request."""
    query: Form = call.query
    dialect = query.dialect
    if not call.data and dialect not in official_names():  # refuse paths: they would name files of the server
        raise RefusedError(400, f"there is no official dialect {dialect[:60]!r}")
    options = {"only": query.only, "exclude": query.exclude, "package": query.package}
    chosen = [word.strip() for word in query.languages.split(",") if word.strip()]
    work = Work(
        dialect=dialect,
        file=query.file if call.data else "",
        languages=list(dict.fromkeys(chosen)),
        folder=_FOLDER,
        options=options,
        archive=archive,
    )
    return await call.station.generator.run(work, call.data)

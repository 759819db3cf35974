"""The generator of libraries in other languages, as the form of `mav gen --ui` offers it."""

from __future__ import annotations

import asyncio
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, Final
from zipfile import ZIP_DEFLATED, ZipFile

from starlette.responses import Response

from mavstack.codegen import language, language_names
from mavstack.codegen.form import GenerationForm
from mavstack.dialects.tables import official_names
from mavstack.dialects.xml_definitions import parse_definition
from mavstack.errors import DialectError
from mavstack.http.bodies import RefusedError
from mavstack.security.roles import Role
from mavstack.server.api_route import ApiRoute, Call
from mavstack.server.fields import Field

if TYPE_CHECKING:
    from collections.abc import Iterator

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
    return await asyncio.to_thread(_problems, call)


async def _generate(call: Call) -> Response:
    data = await asyncio.to_thread(_zip, call)
    headers = {"Content-Disposition": f'attachment; filename="{_FOLDER}.zip"'}
    return Response(data, media_type="application/zip", headers=headers)


def _problems(call: Call) -> dict[str, Any]:
    with _form(call) as (form, folder):
        problems = {name: _without(text, folder) for name, text in form.problems.items()}
        commands = [] if problems else [_without(line, folder) for line in form.commands]
        return {"problems": problems, "commands": commands}


def _zip(call: Call) -> bytes:
    with _form(call) as (form, folder):
        for text in form.problems.values():
            raise RefusedError(400, _without(text, folder))
        for outcome in form.run():
            if outcome.failed:
                raise RefusedError(400, f"{outcome.language}: {_without(outcome.text, folder)}")
        archive = BytesIO()
        with ZipFile(archive, "w", ZIP_DEFLATED) as file:
            for path in sorted((folder / _FOLDER).rglob("*")):
                if path.is_file():
                    file.write(path, path.relative_to(folder))
        return archive.getvalue()


@contextmanager
def _form(call: Call) -> Iterator[tuple[GenerationForm, Path]]:
    """Yield the form of a request, with a folder that is deleted in the end."""
    query = call.query
    chosen = tuple(dict.fromkeys(word.strip() for word in query["languages"].split(",") if word.strip()))
    with TemporaryDirectory(prefix="mavstack-") as name:
        folder = Path(name)
        dialect = query["dialect"]
        if call.data:
            _check_includes(call.data, query["file"])
            dialect = str(folder / query["file"])
            Path(dialect).write_bytes(call.data)
        elif dialect not in official_names():  # a path would name a file of the server
            raise RefusedError(400, f"there is no official dialect {dialect[:60]!r}")
        options = {key: query[key] for key in ("only", "exclude", "package")}
        yield (
            GenerationForm(dialect=dialect, languages=chosen, folder=str(folder / _FOLDER), **options),
            folder,
        )


def _check_includes(data: bytes, name: str) -> None:
    """Refuse a definition that includes others than official ones, which would be files of the server."""
    try:
        definition = parse_definition(data, name, Path(name).stem)
    except DialectError as error:
        raise RefusedError(400, str(error)) from None
    for include in definition.includes:
        if include.removesuffix(".xml") not in official_names():
            raise RefusedError(400, f"only official definitions can be included, not {include[:60]!r}")


def _without(text: str, folder: Path) -> str:
    """Return a text without the temporary folder."""
    return text.replace(f"{folder}/", "")


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

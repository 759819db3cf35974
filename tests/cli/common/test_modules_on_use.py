"""Large modules on first use, in other processes: this one has imported asyncio long ago."""

from __future__ import annotations

import subprocess
import sys

PROGRAM = """
import sys
from mavstack.cli.common.modules_on_use import load_modules_on_use
load_modules_on_use()
import asyncio
print("_ssl" in sys.modules)
{use}
print("_ssl" in sys.modules, type(sys.modules["ssl"]).__name__)
"""


def run(use: str) -> list[str]:
    program = PROGRAM.format(use=use)
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    return done.stdout.split()


def test_programs_without_tls_do_not_load_it():
    assert run("asyncio.run(asyncio.sleep(0))") == ["False", "False", "_OnUse"]


def test_tls_works_when_it_is_used():
    use = """
import ssl
from asyncio import sslproto
async def connect():
    try:
        await asyncio.open_connection("127.0.0.1", 1, ssl=ssl.create_default_context())
    except ConnectionRefusedError:
        assert sslproto.SSLProtocol.__module__ == "asyncio.sslproto"
asyncio.run(connect())
"""
    assert run(use) == ["False", "True", "module"]


def test_a_name_that_the_module_lacks_is_an_attribute_error():
    use = """
import ssl
try:
    ssl.no_such_name
except AttributeError as error:
    assert "no_such_name" in str(error)
"""
    assert run(use) == ["False", "True", "module"]


def test_the_parser_of_a_lean_command_loads_no_tables_of_languages():
    use = """
from mavstack.cli.registry import command_parser
assert "options:" in command_parser("route").format_help()
assert {type(sys.modules[name]).__name__ for name in ("locale", "linecache", "tokenize")} == {"_OnUse"}
"""
    assert run(use) == ["False", "False", "_OnUse"]

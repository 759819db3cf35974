"""Lua: a pure module for Lua 5.3 and later, and for LuaJIT."""

from mavstack.codegen.language import Language
from mavstack.codegen.languages.lua.render import RESERVED_WORDS, render

LANGUAGE = Language(name="lua", title="Lua 5.3 and LuaJIT", render=render, reserved_words=RESERVED_WORDS)

"""Swift: a package without dependencies."""

from mavstack.codegen.language import Language
from mavstack.codegen.languages.swift.render import render
from mavstack.codegen.languages.swift.types import RESERVED_WORDS

LANGUAGE = Language(name="swift", title="Swift 5.5", render=render, reserved_words=RESERVED_WORDS)

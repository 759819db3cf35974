"""Rust: a crate without dependencies, for programs with and without the standard library."""

from mavstack.codegen.language import Language
from mavstack.codegen.languages.rust.render import render
from mavstack.codegen.languages.rust.types import RESERVED_WORDS

LANGUAGE = Language(name="rust", title="Rust, no_std", render=render, reserved_words=RESERVED_WORDS)

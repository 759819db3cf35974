"""The command `mav`, one file a subcommand."""

from __future__ import annotations

"""Build Betaflight's SITL program, against which the interop tests of MSP run.

    python -m tools.betaflight_sitl
    MAVSTACK_BETAFLIGHT_SITL=$(python -m tools.betaflight_sitl --source ~/betaflight) make interop

The public source is fetched once into a cache folder and built there; the last line of the output is the path
of the program. The target leaves out the on-screen display, the video transmitter and the beeper: they are
switched on, so that their messages can be tested too.
"""

from __future__ import annotations

import argparse
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

REPOSITORY = "https://github.com/betaflight/betaflight"
TARGET_HEADER = Path("src/platform/SIMULATOR/target/SITL/target.h")
PLATFORM = Path("src/platform/SIMULATOR/sitl.c")
PROGRAM = Path("obj/main/betaflight_SITL.elf")
#: Functions that the header of the target switches off.
SWITCHED_OFF = ("USE_OSD", "USE_VTX_COMMON", "USE_VTX_CONTROL", "USE_VTX_MSP")
OPTIONS = "USE_OSD USE_OSD_SD USE_OSD_HD USE_VTX USE_BEEPER"
#: The beeper's pins, which the program does not have.
PINS = """
#include "drivers/io.h"
#include "drivers/sound_beeper.h"

void IOWrite(IO_t io, bool value) { (void)io; (void)value; }
void pwmWriteBeeper(bool on) { (void)on; }
void beeperPwmInit(const ioTag_t tag, uint16_t frequency) { (void)tag; (void)frequency; }
"""


def cache_folder() -> Path:
    """Return the folder with the source and the program."""
    caches = os.environ.get("XDG_CACHE_HOME", "")
    return (Path(caches) if caches else Path.home() / ".cache") / "mavstack" / "betaflight"


def with_equipment(header: str) -> str:
    """Return the header of the target, which no longer switches display and transmitter off."""
    return re.sub(rf"^#undef ({'|'.join(SWITCHED_OFF)})\n", "", header, flags=re.MULTILINE)


def prepare(source: Path | None, folder: Path) -> None:
    """Put the source into a folder: a copy of one that is there, or the newest public one."""
    if folder.exists():
        return
    new = folder.with_name(f"{folder.name}.new")
    shutil.rmtree(new, ignore_errors=True)
    new.parent.mkdir(parents=True, exist_ok=True)
    if source is None:
        _run("git", "clone", "--depth", "1", REPOSITORY, str(new))
    else:
        shutil.copytree(source, new, ignore=shutil.ignore_patterns("obj", ".git"))
    header = new / TARGET_HEADER
    header.write_text(with_equipment(header.read_text("utf-8")), "utf-8")
    with (new / PLATFORM).open("a", encoding="utf-8") as platform:
        platform.write(PINS)
    boards = new / "src" / "config"  # a submodule that this target does not need
    boards.mkdir(exist_ok=True)
    (boards / ".git").touch()
    new.rename(folder)


def build(folder: Path, jobs: int) -> Path:
    """Build the program; return its path."""
    _run("make", "-C", str(folder), "TARGET=SITL", "AUTOHYDRATE_STAMPS=", f"OPTIONS={OPTIONS}", f"-j{jobs}")
    return folder / PROGRAM


def _run(*command: str) -> None:
    subprocess.run(command, check=True, stdout=sys.stderr)  # noqa: S603 (fixed programs)


def main() -> int:
    """Build the program and print its path."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument(
        "--source", type=Path, help="a folder with Betaflight's source, instead of the public one"
    )
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="compilers at the same time")
    options = parser.parse_args()
    folder = cache_folder()
    try:
        prepare(options.source, folder)
        print(build(folder, options.jobs))
    except (OSError, subprocess.CalledProcessError) as error:
        print(f"building Betaflight's SITL failed: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())

"""A ROS 2 for tests, in `.tools/ros`: `python -m tools.ros_installation`.

The wheels are those of PyPI (Kilted, x86_64 Linux only). Packages of interfaces that it lacks are compiled
once from our own definitions, which takes some minutes; a stamp of the definitions says whether it is done.
Tests with ROS skip without it.
"""

from __future__ import annotations

import os
import platform
import shutil
import subprocess
import sys
import sysconfig
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from mavstack.bridges.core.types.package import write_package

if TYPE_CHECKING:
    from collections.abc import Sequence

ROOT: Final = Path(__file__).resolve().parents[1]
FOLDER: Final = ROOT / ".tools" / "ros"
#: Packages that are compiled, in their order.
COMPILED: Final = ("tf2_msgs", "geographic_msgs", "mavstack_msgs", "mavros_msgs")
_KILTED: Final = (
    "rclpy==9.1.2 rmw-fastrtps-cpp==9.3.3 rcl-interfaces==2.3.0 diagnostic-msgs==5.5.1 geometry-msgs==5.5.1 "
    "nav-msgs==5.5.1 sensor-msgs==5.5.1 std-srvs==5.5.1 trajectory-msgs==5.5.1 ament-package==0.17.2 "
    "rosidl-default-generators==1.7.1 rosidl-core-generators==0.3.1"
)
_AMENT: Final = (
    "core libraries python include-directories version gen-version-h test target-dependencies "
    "export-dependencies export-include-directories export-libraries export-targets export-interfaces "
    "export-link-flags export-definitions"
)
WHEELS: Final = (
    *(f"ros-kilted-{name}" for name in _KILTED.split()),
    "ros-ament-cmake==2.7.3",
    *(f"ros-ament-cmake-{name}==2.7.3" for name in _AMENT.split()),
    *(f"ros-ament-cmake-{name}==2.7.3" for name in ("gmock", "gtest", "pytest")),
    "ros-ament-cmake-ros-core==0.14.5",
    "ros-ament-cmake-ros==0.14.5",
    "catkin_pkg==1.1.1",
    "lark==1.3.1",
    "empy==3.3.4",
    "numpy>=1.26",
)
#: The folder of Python on the machine that built the wheels, which their CMake files name.
_FOREIGN: Final = "/opt/python/cp"


def main() -> int:
    """Install what is missing."""
    if platform.machine() != "x86_64" or sys.platform != "linux":
        print("the wheels of ROS 2 are for x86_64 Linux only")
        return 1
    if shutil.which("cmake") is None or shutil.which("c++") is None:
        print("cmake and a C++ compiler are missing")
        return 1
    if is_complete():
        return 0
    _run([sys.executable, "-m", "venv", FOLDER])
    _run([FOLDER / "bin" / "python", "-m", "pip", "install", "--quiet", *WHEELS])
    _adapt_paths()
    for package in COMPILED:
        _compile(package)
    _stamp().write_text(_digest(), "utf-8")
    return 0


def is_complete() -> bool:
    """Return whether the installation is there, with the present definitions."""
    return _stamp().exists() and _stamp().read_text("utf-8") == _digest()


def environment() -> dict[str, str]:
    """Return the environment in which Python of the installation imports rclpy, and Mavstack of this tree."""
    packages = f"lib/python{sys.version_info.major}.{sys.version_info.minor}/site-packages"
    built = FOLDER / "built"
    paths = (built / packages, ROOT / "src", ROOT, Path(sysconfig.get_path("purelib")))
    return {
        **os.environ,
        "AMENT_PREFIX_PATH": f"{built}:{FOLDER}",
        "CMAKE_PREFIX_PATH": f"{built}:{FOLDER}",
        "LD_LIBRARY_PATH": f"{built / 'lib'}:{FOLDER / 'lib'}",
        "PATH": f"{FOLDER / 'bin'}:{os.environ['PATH']}",
        "PYTHONPATH": ":".join(map(str, paths)),
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
        "RMW_IMPLEMENTATION": "rmw_fastrtps_cpp",
    }


def _stamp() -> Path:
    return FOLDER / "stamp"


def _digest() -> str:
    definitions = ROOT / "src/mavstack/bridges/core/types/definitions"
    content = b"".join((definitions / f"{name}.txt").read_bytes() for name in COMPILED)
    return sha256(content + " ".join(WHEELS).encode()).hexdigest()


def _adapt_paths() -> None:
    """Replace the folders of the machine that built the wheels in their CMake files."""
    version = f"{sys.version_info.major}{sys.version_info.minor}"
    foreign = f"{_FOREIGN}{version}-cp{version}"
    include = sysconfig.get_path("include")
    for path in (FOLDER / "share").rglob("*.cmake"):
        text = path.read_text("utf-8")
        if foreign in text:
            name = f"python{sys.version_info.major}.{sys.version_info.minor}"
            text = text.replace(f"{foreign}/include/{name}", include)
            path.write_text(text.replace(f"{foreign}/lib/{name}", f"{FOLDER}/lib/{name}"), "utf-8")


def _compile(package: str) -> None:
    source = write_package(package, FOLDER / "sources")
    build = FOLDER / "build" / package
    build.mkdir(parents=True, exist_ok=True)
    environment_of_build = environment() | {"PYTHONPATH": ""}
    options = [
        f"-DCMAKE_INSTALL_PREFIX={FOLDER / 'built'}",
        "-DBUILD_TESTING=OFF",
        "-DCMAKE_C_FLAGS=-O0",
        "-DCMAKE_CXX_FLAGS=-O0",
        f"-DPython3_EXECUTABLE={FOLDER / 'bin' / 'python'}",
    ]
    commands: tuple[list[str], ...] = (["cmake", str(source), *options], ["make", "-j2", "install"])
    for command in commands:
        with (build / f"{command[0]}.log").open("w") as log:
            _run(command, cwd=build, env=environment_of_build, stdout=log, stderr=log)


def _run(command: Sequence[str | Path], **options: Any) -> None:  # noqa: ANN401 (those of subprocess)
    subprocess.run(command, check=True, **options)  # noqa: S603 (commands of this file)


if __name__ == "__main__":
    sys.exit(main())

"""A ROS package of interfaces, for machines whose ROS does not have it: mavstack_msgs, or mavros_msgs."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.bridges.core.types.definitions import (
    definition_of,
    definition_text,
    interface_names,
    package_names,
)
from mavstack.bridges.core.types.hashes import referenced
from mavstack.errors import InvalidArgumentError

if TYPE_CHECKING:
    from pathlib import Path

_CMAKE: Final = """\
cmake_minimum_required(VERSION 3.8)
project({package})
find_package(ament_cmake REQUIRED)
find_package(rosidl_default_generators REQUIRED)
{finds}
rosidl_generate_interfaces(${{PROJECT_NAME}}
{files}
  DEPENDENCIES {dependencies}
)
ament_export_dependencies(rosidl_default_runtime)
ament_package()
"""
_MANIFEST: Final = """\
<?xml version="1.0"?>
<package format="3">
  <name>{package}</name>
  <version>1.0.0</version>
  <description>Interfaces of {package}</description>
  <maintainer email="interfaces@example.com">Mavstack</maintainer>
  <license>MIT</license>
  <buildtool_depend>ament_cmake</buildtool_depend>
  <buildtool_depend>rosidl_default_generators</buildtool_depend>
{depends}
  <exec_depend>rosidl_default_runtime</exec_depend>
  <member_of_group>rosidl_interface_packages</member_of_group>
  <export><build_type>ament_cmake</build_type></export>
</package>
"""


def write_package(package: str, folder: Path) -> Path:
    """Write the sources of a package, to be built by `colcon build`.

    Args:
        package: The name, such as "mavstack_msgs".
        folder: The folder that gets the folder of the package, such as `src` of a workspace.

    Returns:
        The folder of the package.

    Raises:
        InvalidArgumentError: There are no definitions of the package.
    """
    if package not in package_names():
        raise InvalidArgumentError(f"package must be one of {', '.join(package_names())}, got {package!r}")
    own = [name for name in interface_names("msg", "srv", "action") if name.startswith(f"{package}/")]
    target = folder / package
    for name in own:
        _, kind, short = name.split("/")
        path = target / kind / f"{short}.{kind}"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(definition_text(name), "utf-8")
    needed = _dependencies(package, own)
    files = "\n".join(f'  "{kind}/{short}.{kind}"' for _, kind, short in (name.split("/") for name in own))
    finds = "\n".join(f"find_package({name} REQUIRED)" for name in needed)
    cmake = _CMAKE.format(package=package, files=files, finds=finds, dependencies=" ".join(needed))
    depends = "\n".join(f"  <depend>{name}</depend>" for name in needed)
    (target / "CMakeLists.txt").write_text(cmake, "utf-8")
    (target / "package.xml").write_text(_MANIFEST.format(package=package, depends=depends), "utf-8")
    return target


def _dependencies(package: str, names: list[str]) -> list[str]:
    """Return the other packages that the interfaces refer to; those that rosidl adds by itself too."""
    owners = {each.name.split("/")[0] for name in names for each in referenced(definition_of(name).name)}
    if any("/action/" in name for name in names):
        owners.add("action_msgs")
    return sorted(owners - {package})

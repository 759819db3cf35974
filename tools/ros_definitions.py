"""Interface definitions of ROS 2 packages, reduced to facts: `python -m tools.ros_definitions FOLDER…`.

A folder is a `share` folder of a ROS installation, or one that holds the sources of a package. The names and
types of fields, and the constants, are written to `src/mavstack/bridges/core/types/definitions`, one file for
each package. Comments are left out, as are interfaces that nothing in Mavstack uses.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import Final

OUTPUT: Final = Path(__file__).parents[1] / "src/mavstack/bridges/core/types/definitions"
KINDS: Final = ("msg", "srv", "action")
#: The interfaces that are used, by package; an empty text stands for all.
WANTED: Final = {
    "action_msgs": "GoalInfo GoalStatus GoalStatusArray CancelGoal",
    "builtin_interfaces": "",
    "diagnostic_msgs": "DiagnosticArray DiagnosticStatus KeyValue",
    "geographic_msgs": "GeoPoint GeoPointStamped GeoPose GeoPoseStamped",
    "geometry_msgs": "Accel AccelWithCovariance AccelWithCovarianceStamped Point Pose PoseStamped "
    "PoseWithCovariance PoseWithCovarianceStamped Quaternion Transform TransformStamped Twist TwistStamped "
    "TwistWithCovariance TwistWithCovarianceStamped Vector3 Vector3Stamped",
    "mavros_msgs": "",
    "nav_msgs": "Odometry Path",
    "rcl_interfaces": "DescribeParameters FloatingPointRange GetParameterTypes GetParameters IntegerRange "
    "ListParameters ListParametersResult ParameterDescriptor ParameterEvent Parameter ParameterType "
    "ParameterValue SetParameters SetParametersAtomically SetParametersResult",
    "rmw_dds_common": "",
    "sensor_msgs": "BatteryState FluidPressure Imu LaserScan MagneticField NavSatFix NavSatStatus Range "
    "Temperature TimeReference",
    "service_msgs": "",
    "std_msgs": "Float64 Header String UInt32 UInt8",
    "std_srvs": "Empty SetBool Trigger",
    "trajectory_msgs": "MultiDOFJointTrajectory MultiDOFJointTrajectoryPoint",
    "unique_identifier_msgs": "",
}
_COMMENT: Final = re.compile(r"\s*#.*$")


def main(folders: list[str]) -> None:
    """Write the definitions of all packages that the folders hold."""
    for package, names in WANTED.items():
        found = [Path(folder) / package for folder in folders if (Path(folder) / package).is_dir()]
        if not found:
            sys.exit(f"no folder holds {package}")
        (OUTPUT / f"{package}.txt").write_text(package_text(found[0], set(names.split())), "utf-8")


def package_text(package: Path, names: set[str]) -> str:
    """Return the definitions of a package as one text."""
    paths = [path for kind in KINDS for path in sorted((package / kind).glob(f"*.{kind}"))]
    parts = [
        f"== {path.parent.name}/{path.stem}\n{reduced(path.read_text('utf-8'))}"
        for path in paths
        if not names or path.stem in names
    ]
    return "\n".join(parts)


def reduced(text: str) -> str:
    """Return a definition without comments, and with single spaces."""
    lines = (" ".join(_COMMENT.sub("", line).split()) for line in text.splitlines())
    return "".join(f"{re.sub(r' ?= ?', '=', line)}\n" for line in lines if line)


if __name__ == "__main__":
    main(sys.argv[1:])

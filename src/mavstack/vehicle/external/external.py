"""Data of a companion computer for a vehicle: `vehicle.external`.

    vehicle.external.odometry((x, y, z), (w, qx, qy, qz), frame="ENU", body_frame="FLU")
    print(await vehicle.external.check())

Each call sends one message; call it for each measurement, 30 to 50 times a second for estimates of the
position. Times are Unix seconds of this computer: autopilots convert them by TIMESYNC, which a connection
answers with the same clock.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.node.api_object import ReadOnly
from mavstack.services.external import Frame, PoseEstimate, StreamMonitor
from mavstack.services.external.estimates import as_frame
from mavstack.vehicle.external import positioning, surroundings, wind
from mavstack.vehicle.external.check import check
from mavstack.vehicle.external.times import checked

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.dialects import Message
    from mavstack.rotation import Quaternion, Vector
    from mavstack.vehicle.vehicle import Vehicle


class External(ReadOnly):
    """Data of a companion computer for a vehicle; `vehicle.external`.

    Every call that sends raises `InvalidStateError` if the connection is closed, and `InvalidArgumentError`
    for numbers that are not possible.
    """

    vehicle: Vehicle
    monitor: StreamMonitor

    def __init__(self, vehicle: Vehicle) -> None:
        #: The vehicle.
        self.vehicle = vehicle
        #: Measures the rate and the age of the estimates.
        self.monitor = StreamMonitor()

    # Estimates of the position and the attitude of the vehicle

    def odometry(
        self,
        position: Vector | None = None,
        orientation: Quaternion | None = None,
        *,
        velocity: Vector | None = None,
        rotation: Vector | None = None,
        frame: str = Frame.ENU,
        body_frame: str = Frame.FLU,
        pose_covariance: Sequence[float] = (),
        velocity_covariance: Sequence[float] = (),
        reset_counter: int = 0,
        quality: int = 0,
        time: float | None = None,
    ) -> None:
        """Send an estimate of pose and velocity (ODOMETRY).

        Args:
            position: Metres in `frame`; None: not known.
            orientation: The rotation from the body into `frame` as w, x, y, z; None: not known.
            velocity: Metres per second in `body_frame`; None: not known.
            rotation: Radians per second around the axes of `body_frame`; None: not known.
            frame: The axes of the world: "NED" or "ENU" if it knows north; "FRD", "FLU" or the optical axes
                "RDF" if it starts with the heading of the vehicle.
            body_frame: The axes of the body: "FRD", "FLU", or "RDF" of a camera.
            pose_covariance: 36 numbers row by row or the 21 of the upper right triangle, m² and rad²; empty:
                not known.
            velocity_covariance: The same of velocity and rotation.
            reset_counter: Changes with each jump of the estimate, 0 to 255.
            quality: Percent, 0: not known, -1: the source has failed.
            time: The time of the measurement, Unix seconds; None: now.

        Raises:
            InvalidArgumentError: A number or a frame is not possible.
            InvalidStateError: The connection is closed.
        """
        estimate = PoseEstimate(
            position, orientation, velocity, rotation, as_frame(frame), as_frame(body_frame), pose_covariance,
            velocity_covariance, reset_counter, quality,
        )  # fmt: skip
        only_frd = self.vehicle.autopilot == common.MavAutopilot.ARDUPILOTMEGA
        now = self.vehicle.component.now()
        time = now if time is None else checked(time)
        message = estimate.to_odometry(round(time * 1e6), only_frd=only_frd)
        self.vehicle.component.send(message, at_once=True)
        self.monitor.add(time, now, estimate)

    def vision(
        self,
        position: Vector | None = None,
        orientation: Quaternion | None = None,
        *,
        velocity: Vector | None = None,
        frame: str = Frame.ENU,
        body_frame: str = Frame.FLU,
        covariance: Sequence[float] = (),
        reset_counter: int = 0,
        time: float | None = None,
    ) -> None:
        """Send an estimate of a camera (VISION_POSITION_ESTIMATE, VISION_SPEED_ESTIMATE).

        Args:
            position: Metres in `frame`; None: not known.
            orientation: The rotation from the body into `frame` as w, x, y, z; None: not known.
            velocity: Metres per second in `body_frame`, which needs the orientation; None: not known.
            frame: The axes of the world, as for `odometry`.
            body_frame: The axes of the body, as for `odometry`.
            covariance: 36 or 21 numbers, as for `odometry`; empty: not known.
            reset_counter: Changes with each jump of the estimate, 0 to 255.
            time: The time of the measurement, Unix seconds; None: now.

        Raises:
            InvalidArgumentError: A number or a frame is not possible.
            InvalidStateError: The connection is closed.
        """
        estimate = PoseEstimate(
            position, orientation, velocity, None, as_frame(frame), as_frame(body_frame), covariance,
            reset_counter=reset_counter,
        )  # fmt: skip
        now = self.vehicle.component.now()
        time = now if time is None else checked(time)
        self._send_estimate(estimate, time, now, *estimate.to_vision(round(time * 1e6)))

    def mocap(
        self,
        position: Vector,
        orientation: Quaternion,
        *,
        frame: str = Frame.ENU,
        body_frame: str = Frame.FLU,
        covariance: Sequence[float] = (),
        time: float | None = None,
    ) -> None:
        """Send the pose that a motion capture system measures (ATT_POS_MOCAP).

        Args:
            position: Metres in `frame`.
            orientation: The rotation from the body into `frame` as w, x, y, z.
            frame: The axes of the world, as for `odometry`.
            body_frame: The axes of the body, as for `odometry`.
            covariance: 36 or 21 numbers, as for `odometry`; empty: not known.
            time: The time of the measurement, Unix seconds; None: now.

        Raises:
            InvalidArgumentError: A number or a frame is not possible.
            InvalidStateError: The connection is closed.
        """
        estimate = PoseEstimate(
            position, orientation, None, None, as_frame(frame), as_frame(body_frame), covariance
        )
        now = self.vehicle.component.now()
        time = now if time is None else checked(time)
        self._send_estimate(estimate, time, now, estimate.to_mocap(round(time * 1e6)))

    set_origin = positioning.set_origin
    gps = positioning.gps

    # Surroundings of the vehicle

    obstacles = surroundings.obstacles
    distance = surroundings.distance
    landing_target = surroundings.landing_target
    follow_target = surroundings.follow_target
    wind = wind.wind

    check = check

    def _send_estimate(self, estimate: PoseEstimate, time: float, now: float, *messages: Message) -> None:
        for message in messages:
            self.vehicle.component.send(message, at_once=True)
        self.monitor.add(time, now, estimate)

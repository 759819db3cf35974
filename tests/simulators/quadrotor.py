"""A quadrotor of 1.5 kg as an MJCF model: motors in the order and with the directions of PX4."""

from __future__ import annotations

_MOTORS = ((1, -1, -1), (-1, 1, -1), (1, 1, 1), (-1, -1, 1))


def _model() -> str:
    sites = "".join(
        f'<site name="m{number}" pos="{0.177 * forward} {0.177 * left} 0.02"/>'
        for number, (forward, left, _) in enumerate(_MOTORS)
    )
    motors = "".join(
        f'<motor site="m{number}" gear="0 0 1 0 0 {0.05 * turn}" ctrllimited="true" ctrlrange="0 7.5"/>'
        for number, (_, _, turn) in enumerate(_MOTORS)
    )
    return f"""<mujoco>
  <option timestep="0.002" integrator="RK4"/>
  <worldbody>
    <geom type="plane" size="100 100 1"/>
    <body pos="0 0 0.05">
      <freejoint/>
      <inertial pos="0 0 0" mass="1.5" diaginertia="0.029 0.029 0.055"/>
      <geom type="box" size="0.2 0.2 0.05" mass="0"/>
      {sites}
    </body>
  </worldbody>
  <actuator>{motors}</actuator>
</mujoco>"""


QUADROTOR = _model()

"""The scenes in MuJoCo (PyPI `mujoco`), as a flex of two dimensions with self-collision.

Its elastic shell resists stretch and bending, solved implicitly (`integrator="discrete"`). The positions and velocities
of the gripped points are set before every step. Settings: `step` [s].
"""

import mujoco
import numpy as np
from measure import measure
from scenes import AREA_DENSITY, FRAMES_PER_SECOND, GRAVITY

RADIUS = 0.0025  # m; contact begins at twice this distance, which the fall must not skip in one step
YOUNG = 1.1e7  # Pa; with THICKNESS crease's stretch stiffness of cotton jersey, 1.1 kN/m, and a bending length of 1 cm
THICKNESS = 1.0e-4  # m


def model(scene, step):
    points = " ".join(f"{x:.9g}" for x in scene.points.ravel())
    triangles = " ".join(str(k) for k in scene.triangles.ravel())
    return f"""
    <mujoco>
      <option timestep="{step}" gravity="0 0 {-GRAVITY}" integrator="discrete" solver="CG" tolerance="1e-6"/>
      <size memory="4G"/>
      <worldbody>
        <geom type="plane" size="3 3 0.1"/>
        <flexcomp name="sheet" type="direct" dim="2" point="{points}" element="{triangles}"
                  radius="{RADIUS}" mass="{AREA_DENSITY * scene.width * scene.height}">
          <contact selfcollide="auto" condim="3" friction="0.6" solref="0.003"/>
          <elasticity young="{YOUNG}" poisson="0.2" thickness="{THICKNESS}" elastic2d="both"/>
        </flexcomp>
      </worldbody>
    </mujoco>"""


def start(scene, settings):
    steps = round(1.0 / (FRAMES_PER_SECOND * settings["step"]))
    step = 1.0 / (FRAMES_PER_SECOND * steps)
    compiled = mujoco.MjModel.from_xml_string(model(scene, step))
    data = mujoco.MjData(compiled)
    degrees = 3 * scene.gripped[:, None] + np.arange(3)

    def grip(time):
        data.qpos[degrees] = scene.gripped_at(time) - scene.points[scene.gripped]
        data.qvel[degrees] = (scene.gripped_at(time + step) - scene.gripped_at(time)) / step

    def advance(time):
        for k in range(steps):
            grip(time + (k - steps) * step)
            mujoco.mj_step(compiled, data)
        grip(time)
        mujoco.mj_kinematics(compiled, data)
        mujoco.mj_flex(compiled, data)
        return data.flexvert_xpos

    return advance


measure(start, mujoco.__version__, clearance=0.003)

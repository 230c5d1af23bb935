"""Renders the arm's motion with MuJoCo; run as a process of its own, as `film` does.

    python -m spirob.report.clip MOTION.npz CLIP.webp

MOTION holds `angles` of the hinges [rad], (frames, N), and the lengths of a `SpiralArm`.  A broken
graphics driver may end the process instead of raising, and MUJOCO_GL must be set before MuJoCo is
imported.
"""

import argparse
from pathlib import Path

import mujoco
import numpy as np
from PIL import Image

from spirob.geometry import SpiralArm
from spirob.plant.body import build_spec
from spirob.plant.rig import Arm
from spirob.report.arm import RATE
from spirob.robot import Scene

WIDTH, HEIGHT = 480, 360  # pixels
QUALITY = 60
GAP = 0.03  # of a unit's length, between two units
PLAIN = (0.62, 0.76, 0.88, 1.0)
FLANK = (0.0, 0.45, 0.70, 1.0)


def render(angles: np.ndarray, geometry: SpiralArm) -> list[Image.Image]:
    """A picture for each row of hinge angles [rad], seen from above."""
    model = _model(geometry)
    data = mujoco.MjData(model)
    camera = _camera(geometry)
    pictures = []
    with mujoco.Renderer(model, HEIGHT, WIDTH) as renderer:
        renderer.scene.flags[mujoco.mjtRndFlag.mjRND_REFLECTION] = 0
        renderer.scene.flags[mujoco.mjtRndFlag.mjRND_SHADOW] = 0
        for pose in angles:
            data.qpos[: len(pose)] = pose
            mujoco.mj_kinematics(model, data)
            mujoco.mj_camlight(model, data)
            renderer.update_scene(data, camera)
            pictures.append(Image.fromarray(renderer.render()))
    return pictures


def _model(geometry: SpiralArm) -> mujoco.MjModel:
    """The arm of the plant, each unit filled with its trapezoid."""
    arm = Arm()
    spec = build_spec(arm, Scene(), geometry, 1e-3)
    spec.visual.headlight.ambient = [0.5, 0.5, 0.5]
    spec.visual.headlight.diffuse = [0.5, 0.5, 0.5]
    spec.visual.rgba.haze = [1, 1, 1, 1]
    spec.add_texture(
        type=mujoco.mjtTexture.mjTEXTURE_SKYBOX,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_FLAT,
        rgb1=[1, 1, 1],
        rgb2=[1, 1, 1],
        width=16,
        height=16,
    )
    for i in range(geometry.units):
        body = spec.body(f"unit_{i}")
        for geom in body.geoms:
            geom.rgba = FLANK
        spec.add_mesh(name=f"unit_{i}", uservert=_prism(geometry, i, arm.thickness_ratio).ravel())
        body.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname=f"unit_{i}", rgba=PLAIN, mass=0.0)
    return spec.compile()


def _prism(geometry: SpiralArm, i: int, thickness: float) -> np.ndarray:
    """Corners of a unit [m], (12, 3)."""
    w, length = geometry.half_width[i], geometry.unit_length[i]
    inset = w * np.tan(geometry.unit_angle[i] / 2)
    gap = GAP * length
    flat = [(gap, 0.0), (length - gap, 0.0)]
    flat += [(x, y) for y in (w, -w) for x in (inset + gap, length - inset - gap)]
    return np.array([(x, y, side * thickness * w) for x, y in flat for side in (1, -1)])


def _camera(geometry: SpiralArm) -> mujoco.MjvCamera:
    length = float(geometry.unit_length.sum())
    camera = mujoco.MjvCamera()
    camera.lookat = [0.45 * length, 0.0, 0.0]
    camera.distance, camera.azimuth, camera.elevation = 1.6 * length, 90, -70
    return camera


def main(source: str, target: str) -> None:
    """Render the angles in one file into the clip in another."""
    with np.load(source, allow_pickle=False) as motion:
        angles, lengths = motion["angles"], {k: v for k, v in motion.items() if k != "angles"}
    first, *rest = render(angles, SpiralArm(**lengths))
    shown = round(1e3 / RATE)  # ms
    first.save(
        Path(target), save_all=True, append_images=rest, duration=shown, loop=0, quality=QUALITY
    )


if __name__ == "__main__":
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("motion", metavar="MOTION.npz")
    parser.add_argument("clip", metavar="CLIP.webp")
    given = parser.parse_args()
    main(given.motion, given.clip)

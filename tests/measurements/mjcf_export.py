#!/usr/bin/env python3
"""Compares exported hands with the MuJoCo of this Python, whichever version it is.

    build/release/tests/measurements/exported_hands FOLDER
    PYTHON tests/measurements/mjcf_export.py FOLDER

Prints, for each hand, the largest differences of lengths [m] and moment arms [m/rad] of all cables to Gauntlet's own in
1000 random postures, and whether each motor moves something. Ends with 1 beyond 1e-6, or if the hand does not stay
still at control 0. With OSMesa or EGL (MUJOCO_GL) it also draws each hand into NAME.VERSION.ppm.
"""
import os
import pathlib
import sys

import mujoco
import numpy as np

LIMIT = 1e-6


def moment_arms(model, data):
    """Of all tendons, without zeros left out."""
    if data.ten_J.ndim == 2:
        return data.ten_J
    arms = np.zeros((model.ntendon, model.nv))
    begin, count, columns = ((model.ten_J_rowadr, model.ten_J_rownnz, model.ten_J_colind)
                             if hasattr(model, "ten_J_rowadr")
                             else (data.ten_J_rowadr, data.ten_J_rownnz, data.ten_J_colind))
    for tendon in range(model.ntendon):
        row = slice(begin[tendon], begin[tendon] + count[tendon])
        arms[tendon, columns.ravel()[row]] = data.ten_J.ravel()[row]
    return arms


def differences(model, data, text):
    """Largest differences of lengths and of moment arms to the postures in `text`."""
    names = text.split("\n", 1)[0].split()
    if not names:
        return 0.0, 0.0
    rows = np.loadtxt(text.split("\n")[1:])
    tendons = [model.tendon(name).id for name in names]
    length = arm = 0.0
    for row in rows:
        data.qpos[:] = row[:model.nq]
        mujoco.mj_forward(model, data)
        own = row[model.nq:].reshape(len(names), 1 + model.nv)
        length = max(length, np.abs(data.ten_length[tendons] - own[:, 0]).max())
        arm = max(arm, np.abs(moment_arms(model, data)[tendons] - own[:, 1:]).max())
    return length, arm


def speed_at_rest(model, data):
    """The largest speed of a joint 3 s after the keyframe, at control 0 [rad/s]."""
    mujoco.mj_resetDataKeyframe(model, data, 0)
    while data.time < 3.0:
        mujoco.mj_step(model, data)
    hinges = model.jnt_dofadr[model.jnt_type == mujoco.mjtJoint.mjJNT_HINGE]
    return np.abs(data.qvel[hinges]).max()


def draw(model, data, file):
    """The hand from its camera, as a PPM."""
    with mujoco.Renderer(model, 480, 640) as renderer:
        renderer.update_scene(data, camera="hand")
        picture = renderer.render()
    file.write_bytes(b"P6 640 480 255\n" + picture.tobytes())
    return picture.std()


def main():
    folder = pathlib.Path(sys.argv[1])
    failed = False
    print("| hand | MuJoCo | cables | lengths [m] | moment arms [m/rad] | speed at rest [rad/s] |")
    print("|---|---|---|---|---|---|")
    for file in sorted(folder.glob("*.xml")):
        model = mujoco.MjModel.from_xml_path(str(file))
        data = mujoco.MjData(model)
        length, arm = differences(model, data, file.with_suffix(".txt").read_text())
        speed = speed_at_rest(model, data)
        failed |= max(length, arm) > LIMIT or speed > 0.01
        print(f"| {file.stem} | {mujoco.__version__} | {model.ntendon} | {length:.1e} | {arm:.1e} | {speed:.1e} |")
        if "MUJOCO_GL" in os.environ:
            failed |= draw(model, data, file.with_suffix(f".{mujoco.__version__}.ppm")) < 1.0
    sys.exit(int(failed))


if __name__ == "__main__":
    main()

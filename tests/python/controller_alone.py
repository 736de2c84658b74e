"""Filters and a robot by gauntlet_controller: without `gauntlet` it writes their numbers, beside `gauntlet` it compares them.

    controller_alone.py ROBOT_FILE NUMBERS.npy
"""
import importlib.util
import pathlib
import sys

import numpy as np

import gauntlet_controller as alone


def numbers(module, robot):
    """All that a robot would read, as one array; no two columns are alike."""
    counts = 500 + np.random.default_rng(1).normal(size=(400, 18)).cumsum(axis=0)
    controller = module.Controller(robot)
    parts = [controller.steps(counts), module.Controller(robot).steps(counts[::2])]
    parts += [module.filter(counts, kind, rate_hz=1000.0) for kind in module.filter_kinds() if kind != "external"]
    one = module.Filter("one_euro", rate_hz=1000.0)
    parts.append(np.array([one.step(sample) for sample in counts]))
    parts.append(np.array([controller.step(sample) for sample in counts[:50]]))
    parts.append(np.array([controller.linearised_angle_rad, controller.filtered_angle_rad, controller.target_angle_rad]))
    for part in parts:
        assert len(np.unique(part.T, axis=0)) == part.shape[1], "columns are alike"
    return np.concatenate([np.asarray(part, float).ravel() for part in parts])


def main():
    robot, file = sys.argv[1], pathlib.Path(sys.argv[2])
    result = numbers(alone, robot)
    if importlib.util.find_spec("gauntlet") is None:
        assert alone.check_robot(robot) is not None
        np.save(file, result)
        return
    import gauntlet

    assert np.array_equal(result, np.load(file)), "other numbers than before"
    assert np.array_equal(result, numbers(gauntlet, robot)), "other numbers than those of gauntlet"
    print(f"gauntlet_controller {alone.__version__}: {len(result)} numbers as of gauntlet, numpy {np.__version__}")


if __name__ == "__main__":
    main()

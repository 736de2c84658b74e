"""Gauntlet's filters and controllers alone, for a computer on the robot: the same numbers as of `gauntlet`, without the
simulation. Settings are a file, the text of a YAML file, or a dict; a mistake is a SettingError with place and key.
"""
from __future__ import annotations

try:
    import numpy as _numpy
except ModuleNotFoundError:
    raise ImportError("gauntlet_controller needs numpy: pip install numpy") from None

from . import _core
from ._errors import Remark, RunError, SettingError
from ._robot import Controller, Filter, check_robot, filter, filter_kinds
from ._settings import Settings, to_yaml

__version__: str = _core.__version__
__all__ = ["Controller", "Filter", "Remark", "RunError", "SettingError", "Settings", "check_robot", "filter", "filter_kinds", "to_yaml"]

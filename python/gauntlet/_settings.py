"""Settings as files, texts and dicts: all become the text of a YAML file, which one reader checks."""
from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Optional, Tuple, Union

from ._errors import SettingError

if TYPE_CHECKING:  # gauntlet_controller has none
    from ._filters import Filters

#: A file (the name of a ready one, too), the text of a YAML file (of two lines or more), or a dict.
Settings = Union[str, "os.PathLike[str]", Mapping]


def to_yaml(settings: Mapping[str, Any]) -> str:
    """The text of a YAML file with these settings, a key per line, as messages count the lines.

    numpy numbers and arrays count as numbers and lists, paths as texts.
    """
    lines: list[str] = []
    _add_map(settings, "", lines)
    return "".join(line + "\n" for line in lines)


def source(settings: Settings, name: str, filters: Optional[Filters] = None) -> Tuple[str, Optional[str]]:
    """File, and text: None where the file is to be read. `name` stands for the file in messages.

    `filters` gets the filters that are objects of Python; None: there can be none."""
    if isinstance(settings, Mapping):
        return name, to_yaml(filters.replace(settings) if filters else settings)
    if isinstance(settings, str) and "\n" in settings:
        return name, settings
    if isinstance(settings, (str, os.PathLike)):
        return os.fspath(settings), None
    raise TypeError(f"{name} must be a file, the text of a YAML file or a dict, not {type(settings).__name__}")


def overrides(settings: Union[None, Mapping[str, Any], Sequence[str]], filters: Optional[Filters] = None) -> list[str]:
    """As --set takes them: {"glove.motion.duration_s": 2} is ["glove.motion.duration_s=2"]. `filters` as of source()."""
    if settings is None:
        return []
    if isinstance(settings, Mapping):
        return [f"{key}={_flow(filters.replace(value) if filters else value, key)}" for key, value in settings.items()]
    if isinstance(settings, str):
        return [settings]
    return [str(text) for text in settings]


def _add_map(settings: Mapping[str, Any], indent: str, lines: list[str]) -> None:
    for key, value in settings.items():
        if not isinstance(key, str):
            raise SettingError("", str(key), f"is a key of type {type(key).__name__}, must be a text")
        _add(f"{indent}{_text(key)}:", value, indent, lines, key)


def _add(head: str, value: Any, indent: str, lines: list[str], key: str) -> None:
    value = _plain(value)
    if isinstance(value, Mapping) and value:
        lines.append(head)
        _add_map(value, indent + "  ", lines)
    elif isinstance(value, (list, tuple)) and any(isinstance(item, (Mapping, list, tuple)) for item in value):
        lines.append(head)
        for item in value:
            if isinstance(item, Mapping) and item:
                inner: list[str] = []
                _add_map(item, indent + "    ", inner)
                lines.append(f"{indent}  - {inner[0].lstrip()}")
                lines.extend(inner[1:])
            else:
                lines.append(f"{indent}  - {_flow(item, key)}")
    else:
        lines.append(f"{head} {_flow(value, key)}")


def _plain(value: Any) -> Any:
    """numpy's numbers and arrays as Python's."""
    if hasattr(value, "tolist") and hasattr(value, "dtype"):
        return value.tolist()
    return os.fspath(value) if isinstance(value, os.PathLike) else value


def _flow(value: Any, key: str) -> str:
    value = _plain(value)
    if value is None:
        return ""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float):
        return {"inf": ".inf", "-inf": "-.inf", "nan": ".nan"}.get(repr(value), repr(value))
    if isinstance(value, str):
        return _text(value)
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_flow(item, key) for item in value) + "]"
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{_text(str(k))}: {_flow(v, key)}" for k, v in value.items()) + "}"
    allowed = "a number, text, list or dict"
    if hasattr(value, "step"):
        allowed = "the class, or a function that makes such an object: each trial needs a new one"
    raise SettingError("", key, f"is of type {type(value).__name__}, must be {allowed}")


def _text(text: str) -> str:
    """Plain where it cannot be anything else, else in double quotes."""
    is_plain = text.replace("_", "a").replace(".", "a").replace("/", "a").isalnum() and text.isascii()
    if is_plain and text[0].isalpha() and text.lower() not in ("true", "false", "yes", "no", "on", "off", "null", "y", "n"):
        return text
    return json.dumps(text, ensure_ascii=False)

"""Exceptions and warnings of Gauntlet."""


class SettingError(ValueError):
    """A mistake in settings or data.

    place    file:line:column, or the argument; empty if unknown
    key      path of keys, joined by dots; empty if unknown
    problem  what is wrong, and what is allowed
    """

    def __init__(self, place: str, key: str, problem: str) -> None:
        super().__init__(place, key, problem)
        self.place = place
        self.key = key
        self.problem = problem

    def __str__(self) -> str:
        return ": ".join(part for part in (self.place, self.key, self.problem) if part)


class RunError(RuntimeError):
    """The run failed although the settings were right: a full disk, a diverged simulation."""


class Remark(UserWarning):
    """What was repaired, replaced or ignored, and warnings about scores."""

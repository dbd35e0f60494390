"""Errors that users see. Each message names the rule, what was got, and the valid options or the remedy."""

from __future__ import annotations

import difflib
from collections.abc import Iterable


class PliantError(Exception):
    """Base class of every error that pliant raises on purpose. The command line turns it into exit code 2."""


class ConfigError(PliantError):
    """A parameter, key or file content that breaks a rule."""


class RobotError(PliantError):
    """A robot that cannot be loaded, or that lacks a frame or a joint."""


class UnknownFrameError(RobotError):
    """A frame that a robot does not have."""


class ShapeError(PliantError):
    """An array whose shape does not fit the robot or the task."""


class SignalError(PliantError):
    """A signal that is not finite, or that arrived out of order."""


class OutputError(PliantError):
    """A file or folder that cannot be written or read."""


class MissingExtraError(PliantError):
    """An optional dependency that is not installed."""


class RunFailedError(PliantError):
    """A run that started and broke a safety rule on the way. The command line turns it into exit code 1."""


def told(error: BaseException) -> str:
    """Type and text of somebody else's error, in one line of at most 300 characters."""
    try:
        text = " ".join(str(error).split())
    except Exception:
        text = ""
    name = type(error).__name__
    return f"{name}: {text[:300]}" if text else name


def options(names: Iterable[str], got: str | None = None) -> str:
    """A readable list of valid names, with the closest one first when `got` looks like a typing slip.

    Args:
        names: valid names.
        got: what the user typed, if anything.

    Returns:
        For example ``"valid: 'a', 'b' (did you mean 'a'?)"``.
    """
    known = sorted(map(str, names))
    text = "valid: " + ", ".join(repr(name) for name in known) if known else "there is none"
    close = difflib.get_close_matches(got, known, n=1) if got else []
    return f"{text} (did you mean {close[0]!r}?)" if close else text

"""How every command ends: with an exit code and, after an error, one sentence."""

from __future__ import annotations

import functools
import os
import sys
import tempfile
import traceback
from collections.abc import Callable
from typing import ParamSpec

import typer
from rich.console import Console

from pliant import __version__
from pliant.contract import stale
from pliant.errors import PliantError, RunFailedError, told

_err = Console(stderr=True)

P = ParamSpec("P")
_LONGEST = 1200  # characters of a sentence


def guarded(command: Callable[P, None]) -> Callable[P, None]:
    """Exit code 2 for bad input, 1 when a run failed, 130 after Ctrl-C: one sentence, never a traceback.

    An unexpected error ends with 2 as well; its traceback is written to a file that the sentence names."""

    @functools.wraps(command)
    def wrapped(*args: P.args, **kwargs: P.kwargs) -> None:
        try:
            command(*args, **kwargs)
        except RunFailedError as error:
            _complain("failed", str(error))
            raise typer.Exit(1) from None
        except PliantError as error:
            _complain("error", str(error))
            raise typer.Exit(2) from None
        except KeyboardInterrupt as error:
            _complain("interrupted", str(error) or "what was recorded until now is kept")
            raise typer.Exit(130) from None
        except (typer.Exit, typer.Abort, BrokenPipeError):  # not pliant's errors
            raise
        except (Exception, SystemExit) as error:
            if isinstance(error.__context__, BrokenPipeError):  # rich raises SystemExit when the pipe is closed
                raise
            if sentence := stale(error):
                _complain("error", sentence)
                raise typer.Exit(2) from None
            _complain("error", f"pliant {__version__} did not foresee this ({told(error)}); {_kept()}")
            raise typer.Exit(2) from None

    return wrapped


def _complain(kind: str, text: str) -> None:
    if len(text) > _LONGEST:  # an argument with thousands of characters
        text = f"{text[: _LONGEST // 2]} … {text[-_LONGEST // 2 :]}"
    _err.print(f"{kind}: {text}", style="red", markup=False, highlight=False, soft_wrap=True)


def _kept() -> str:
    """Writes the traceback of the present error to a file. Returns a text that names the file."""
    text = f"pliant {__version__}: {sys.argv[1:]!r}\n\n{traceback.format_exc()}"
    try:
        file, name = tempfile.mkstemp(prefix="pliant-", suffix=".txt", text=True)
        with os.fdopen(file, "w", encoding="utf-8", errors="backslashreplace") as stream:
            stream.write(text)
    except OSError:
        return "and its traceback could not be written to a file"
    return f"the traceback, which a report should have, is in {name}"

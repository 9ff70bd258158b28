"""Commands: the ``coadjoint`` program, a group of commands with one short module each.

Comes in: the command line. Goes out: tables and JSON on standard output, errors and progress on
standard error, and an exit status:

    0    all is well
    1    a check failed: a claim refuted, forms that disagree, generated files that drifted
    2    the input was wrong: the command line, a spec, a place to write to; or the machine refuses
         something: a full disk, a limit, a closed standard output
    70   a fault of coadjoint itself (EX_SOFTWARE); please report it
    130  interrupted from the keyboard

A command's module is imported when the command is used, and what it works with when it runs, so
that ``coadjoint --help`` loads click and nothing else. Read next: `coadjoint.cli.regenerate`.
"""

from __future__ import annotations

import errno
import os
import sys
import traceback
from collections.abc import Sequence
from difflib import get_close_matches
from importlib import import_module
from pathlib import Path
from typing import Any, Final

import click

from coadjoint import __version__
from coadjoint.cli.output import explain_unwritten, say
from coadjoint.errors import CoadjointError, OutputError, shorten, system_error

#: Commands in the order of the help; each is the object ``command`` of the module of its name.
COMMANDS: Final = (
    "regenerate",
    "list",
    "show",
    "book",
    "algebra",
    "prove",
    "crosscheck",
    "simulate",
    "export",
    "explore",
    "new",
    "doctor",
    "schema",
    "completion",
)
INTERNAL_FAULT: Final = 70
INTERRUPTED: Final = 130


class Commands(click.Group):
    """The group of commands: imports them on use, and turns errors into an exit status."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Names of the commands, in the order of the help."""
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """A command, from its module."""
        if cmd_name not in COMMANDS:
            return None
        command: click.Command = import_module(f"coadjoint.cli.{cmd_name}").command
        return command

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """The command that is meant; an unknown one is answered with the nearest."""
        if args[0] not in COMMANDS and not args[0].startswith("-"):
            near = get_close_matches(args[0], COMMANDS, n=1)
            hint = f"Did you mean {near[0]!r}?" if near else f"There are {', '.join(COMMANDS)}."
            ctx.fail(f"no command is called {args[0]!r}. {hint}")
        return super().resolve_command(ctx, args)

    def main(self, args: Sequence[str] | None = None, *rest: Any, **options: Any) -> Any:
        """Run the program; an error of a standard stream is reported as such."""
        if sys.stdout is None or sys.stderr is None or sys.stdin is None:
            _open_closed_streams()
        try:
            return super().main(args, *rest, **options)
        except OSError as error:  # from click's own output, e.g. that of --help
            say(f"error: {explain_unwritten(error)}", err=True)
            sys.exit(OutputError.exit_status)

    def invoke(self, ctx: click.Context) -> None:
        """Run a command, which returns its exit status or None."""
        try:
            status = super().invoke(ctx)
            _flush()  # so that a reader who left is noticed here and not at the exit
        except (click.ClickException, click.exceptions.Exit, click.Abort, BrokenPipeError):
            raise  # click's own: usage errors are 2; a reader of the pipe who left is 1
        except KeyboardInterrupt:
            say("interrupted", err=True)
            status = INTERRUPTED
        except CoadjointError as error:
            status = error.exit_status
            self._report(ctx, f"error: {error}")
        except Exception as error:
            refused = _refusal(error) if isinstance(error, OSError | ImportError) else None
            if refused is not None:
                status = refused.exit_status
                self._report(ctx, f"error: {refused}")
            else:  # whatever it is, people get one line and the way to report it
                status = INTERNAL_FAULT
                again = f"coadjoint --debug {ctx.invoked_subcommand} ..."
                fault = shorten(f"{type(error).__name__}: {error}")
                self._report(
                    ctx,
                    f"error: a fault of coadjoint itself: {fault}. "
                    f"Please report it with the output of `{again}`.",
                )
        ctx.exit(status or 0)

    @staticmethod
    def _report(ctx: click.Context, message: str) -> None:
        """An error for people, after its traceback if that is asked for."""
        if ctx.params["debug"]:
            say(traceback.format_exc(), err=True)
            # What a bounded child found wrong with itself comes with its own traceback.
            say(getattr(sys.exception(), "traceback", ""), err=True)
        say(message, err=True)


def _flush() -> None:
    """Hand on what standard output still holds.

    Raises:
        OutputError: It takes no more.
    """
    try:
        sys.stdout.flush()
    except BrokenPipeError:
        raise
    except OSError as error:
        raise explain_unwritten(error) from error


def _refusal(error: OSError | ImportError) -> OutputError | None:
    """A refusal of the operating system as an error with its remedy; else None."""
    refused = system_error(error)
    if isinstance(error, ImportError):
        return refused
    # Files that are written have names; what has none is the output, e.g. of --help, by click.
    nameless = error.filename is None and error.errno != errno.ENOENT
    return explain_unwritten(error) if refused is not None and nameless else refused


def _open_closed_streams() -> None:
    """Put nothing in the place of standard streams that are closed; without an output, end.

    A file that is opened later would otherwise take their number, and get what is printed.
    """
    while (handle := os.open(os.devnull, os.O_RDWR)) <= 2:
        pass
    os.close(handle)
    if sys.stderr is None:
        sys.stderr = Path(os.devnull).open("w")  # noqa: SIM115 (open as long as the program runs)
    if sys.stdout is None:
        say(
            "error: standard output is closed; expected a place to write to. To drop what is "
            "printed, add >/dev/null",
            err=True,
        )
        sys.exit(OutputError.exit_status)


@click.group(cls=Commands, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="coadjoint")
@click.option("--debug", is_flag=True, help="Show the traceback of an error.")
def main(**_: Any) -> None:
    """Turn declared mechanical systems into proved equations and verified kernels.

    SYSTEM is the name of a shipped system, as `coadjoint list` shows them; SPEC is the path of a
    .toml file. Exit status: 0 success, 1 a check failed, 2 wrong input.
    """

"""Command ``completion``: the script that lets a shell complete commands, options and systems.

Comes in: the name of a shell. Goes out: its script, from click.
"""

from __future__ import annotations

import click
from click.shell_completion import get_completion_class

from coadjoint.cli.output import say


@click.command("completion")
@click.argument("shell", type=click.Choice(["bash", "zsh", "fish"]))
@click.pass_context
def command(context: click.Context, shell: str) -> None:
    """Print the completion script of a shell.

    bash: eval "$(coadjoint completion bash)" in ~/.bashrc; zsh likewise in ~/.zshrc; fish:
    coadjoint completion fish > ~/.config/fish/completions/coadjoint.fish
    """
    made = get_completion_class(shell)
    assert made is not None, shell
    root = context.find_root()
    say(made(root.command, {}, "coadjoint", "_COADJOINT_COMPLETE").source())

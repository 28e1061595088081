"""`d3a completion`: the line for a shell's start-up file that lets Tab complete."""

from __future__ import annotations

import click

SHELLS = ("bash", "zsh", "fish")
VARIABLE = "_D3A_COMPLETE"


@click.command("completion")
@click.argument("shell", type=click.Choice(SHELLS))
def command(shell: str) -> None:
    r"""Let the shell complete commands and the store's words.

    Prints the lines for its start-up file.

    \b
    bash   eval "$(d3a completion bash)"                          in ~/.bashrc
    zsh    eval "$(d3a completion zsh)"                           in ~/.zshrc
    fish   d3a completion fish > ~/.config/fish/completions/d3a.fish
    """
    from click.shell_completion import get_completion_class

    from assistant.cli import main

    kind = get_completion_class(shell)
    if kind is None:  # click has dropped a shell
        raise click.UsageError(f"There is no completion for {shell}.")
    click.echo(kind(main, {}, "d3a", VARIABLE).source())

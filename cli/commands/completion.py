"""`sketchsim completion`: what a shell needs to complete this command's words."""

from __future__ import annotations

import argparse
from typing import Any

__all__ = ["configure"]

EPILOG = """\
to have it in every new shell:
  bash   sketchsim completion bash > ~/.local/share/bash-completion/completions/sketchsim
  zsh    sketchsim completion zsh > ~/.zfunc/_sketchsim     (with ~/.zfunc in fpath)
  fish   sketchsim completion fish > ~/.config/fish/completions/sketchsim.fish
"""

FILES, FOLDERS = {"INPUT", "OUT", "PNG"}, {"DIR", "FOLDER"}  # what an argument takes, by its metavar


def configure(p: argparse.ArgumentParser) -> None:
    """Declare the command's options."""
    p.description = "Print a script that completes commands and options."
    p.epilog = EPILOG
    p.add_argument("shell", choices=("bash", "zsh", "fish"))
    p.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    import shtab

    from cli.main import build_parser

    parser = build_parser()
    _complete_paths(parser, shtab.FILE, shtab.DIRECTORY)
    print(shtab.complete(parser, options.shell))
    return 0


def _complete_paths(parser: argparse.ArgumentParser, files: object, folders: object) -> None:
    """Mark the arguments, of all commands, that take paths."""
    for action in parser._actions:
        marked: Any = action  # shtab reads an attribute that argparse doesn't have
        if isinstance(action, argparse._SubParsersAction):
            for command in action.choices.values():
                _complete_paths(command, files, folders)
        elif action.metavar in FILES:
            marked.complete = files
        elif action.metavar in FOLDERS:
            marked.complete = folders

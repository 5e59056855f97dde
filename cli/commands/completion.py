"""`sketchsim completion`: what a shell needs to complete this command's words."""

from __future__ import annotations

import argparse

__all__ = ["configure", "words_of"]

EPILOG = """\
to have it in every new shell:
  bash   sketchsim completion bash > ~/.local/share/bash-completion/completions/sketchsim
  zsh    sketchsim completion zsh > ~/.zfunc/_sketchsim     (with ~/.zfunc in fpath)
  fish   sketchsim completion fish > ~/.config/fish/completions/sketchsim.fish
"""

BASH = """\
_sketchsim() {{
    local word="${{COMP_WORDS[COMP_CWORD]}}" before="${{COMP_WORDS[COMP_CWORD-1]}}" words=""
    COMPREPLY=()
    case "${{COMP_WORDS[1]}} $before" in
{choices}
    *)
        case "$COMP_CWORD ${{COMP_WORDS[1]}}" in
        1\\ *) words="{commands}" ;;
{options}
        esac ;;
    esac
    if [[ $COMP_CWORD -eq 1 || $word == -* || -n $exact ]]; then
        COMPREPLY=($(compgen -W "$words" -- "$word"))
    fi
}}
complete -o default -F _sketchsim sketchsim
"""


def configure(p: argparse.ArgumentParser) -> None:
    """Declare the command's options."""
    p.description = "Print a script that completes commands and options."
    p.epilog = EPILOG
    p.add_argument("shell", choices=("bash", "zsh", "fish"))
    p.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    from cli.main import build_parser

    words = words_of(build_parser())
    print({"bash": _bash, "zsh": _zsh, "fish": _fish}[options.shell](words), end="")
    return 0


Words = dict[str, dict[str, list[str]]]


def words_of(parser: argparse.ArgumentParser) -> Words:
    """For each command its options, and for each option the words that it takes; "" is what stands alone."""
    found: Words = {}
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for name, command in action.choices.items():
                found[name] = {}
                for option in command._actions:
                    choices = [str(choice) for choice in option.choices or ()]
                    for flag in option.option_strings or [""]:
                        found[name].setdefault(flag, []).extend(choices)
    return found


def _bash(words: Words) -> str:
    choices = [
        f'    "{command} {flag}") COMPREPLY=($(compgen -W "{" ".join(values)}" -- "$word")); return ;;'
        for command, flags in words.items()
        for flag, values in flags.items()
        if flag and values
    ]
    options = [
        f'        *\\ {command}) words="{" ".join([*filter(None, flags), *flags.get("", [])])}"'
        f"{'; exact=1' if flags.get('') else ''} ;;"
        for command, flags in words.items()
    ]
    script = BASH.format(choices="\n".join(choices), options="\n".join(options), commands=" ".join(words))
    return script.replace('words=""\n', 'words="" exact=""\n')


def _zsh(words: Words) -> str:
    return "#compdef sketchsim\nautoload -U +X bashcompinit && bashcompinit\n" + _bash(words)


def _fish(words: Words) -> str:
    lines = [f"complete -c sketchsim -n __fish_use_subcommand -a '{' '.join(words)}'"]
    for command, flags in words.items():
        inside = f"complete -c sketchsim -n '__fish_seen_subcommand_from {command}'"
        for flag, values in flags.items():
            named = f" -l {flag[2:]}" if flag.startswith("--") else f" -s {flag[1:]}" if flag else ""
            given = f" -x -a '{' '.join(values)}'" if values else ""
            if named or given:
                lines.append(inside + named + given)
    return "\n".join(lines) + "\n"

#!/usr/bin/env python3
"""Generates the list of commands, their reference page, and the Python functions.

Usage: generate.py [--check] [PROGRAM]. PROGRAM is the program `optimize`, which is built if omitted. With --check
nothing is written, and the exit code is 1 if a file is out of date.
"""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).parent))

from python_modules import modules  # noqa: E402

ROOT = Path(__file__).resolve().parents[1]
COMMANDS = ROOT / "src/commands"
BUILD = ["cargo", "build", "--release", "--locked", "--quiet", "--bin", "optimize"]


def paths() -> list[tuple[str, ...]]:
    """Returns the module path of each command; a folder is a group of commands."""
    files = (file.relative_to(COMMANDS).with_suffix("") for file in COMMANDS.rglob("*.rs"))
    return sorted(file.parts for file in files if file.name != "mod")


def command_list() -> str:
    """Returns the text of `src/commands/mod.rs`."""
    alone = [path[0] for path in paths() if len(path) == 1]
    groups = sorted({path[0] for path in paths() if len(path) > 1})
    lines = [
        "//! The commands of `optimize`, one file each. Written by `scripts/generate.py` from the files in this folder.",
        "",
        *(f"pub mod {name};" for name in alone),
    ]
    for group in groups:
        members = [f"    pub mod {path[1]};" for path in paths() if path[0] == group and len(path) > 1]
        lines += ["", f"/// `optimize {group}`.", f"pub mod {group} {{", *members, "}"]
    lines += ["", "use crate::command::Command;", "", "/// All commands.", "pub static COMMANDS: &[Command] = &["]
    for path in paths():
        words = ", ".join(f'"{word.replace("_", "-")}"' for word in path)
        lines.append(f"    Command::of::<{'::'.join(path)}::Request>(&[{words}]),")
    return "\n".join([*lines, "];", ""])


def description(program: str, form: str) -> str:
    """Returns the program's description of its commands, in Markdown or JSON."""
    done = subprocess.run([program, "man", "--format", form], stdout=subprocess.PIPE, text=True, check=True)
    return done.stdout


def files(program: str | None) -> dict[Path, str]:
    """Returns the texts by file. Without a program, first writes the list of commands and builds one."""
    texts = {COMMANDS / "mod.rs": command_list()}
    if program is None:
        write(texts)
        subprocess.run(BUILD, cwd=ROOT, check=True)
        program = str(ROOT / "target/release/optimize")
    texts[ROOT / "docs/cli.md"] = description(program, "markdown")
    for name, text in modules(json.loads(description(program, "json"))).items():
        texts[ROOT / "python/finger_opt" / name] = text
    return texts


def write(texts: dict[Path, str]) -> None:
    """Writes the files that are out of date."""
    for file, text in texts.items():
        if not current(file, text):
            file.write_text(text, encoding="utf-8")


def current(file: Path, text: str) -> bool:
    """Returns whether a file has this text."""
    return file.exists() and file.read_text(encoding="utf-8") == text


def main(arguments: list[str]) -> int:
    """Writes the files, or lists those that are out of date."""
    check = "--check" in arguments
    programs = [argument for argument in arguments if not argument.startswith("--")]
    if check and not programs:
        sys.exit("generate.py: --check needs PROGRAM")
    texts = files(programs[0] if programs else None)
    if not check:
        write(texts)
        return 0
    stale = [str(file.relative_to(ROOT)) for file, text in texts.items() if not current(file, text)]
    for file in stale:
        print(f"{file} is out of date: run scripts/generate.py", file=sys.stderr)
    return 1 if stale else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

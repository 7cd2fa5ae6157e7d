"""The commands of the programs and their options, as the programs' own --help lists them."""

import re
import subprocess


def help_of(build, command):
    program, *verb = command.split()
    return subprocess.run([f"{build}/bin/{program}", *verb, "--help"], check=True, capture_output=True, text=True).stdout


def commands(build):
    """{"psf": [...], "psf filter": ["-h", "--help", "-o", "--output", ...], ...}"""
    found = {}
    for program in ("psf", "psf-render", "psf-bench"):
        listed = help_of(build, program).partition("Subcommands:")[2].partition("\n\n")[0]
        verbs = re.findall(r"^  ([a-z]+) ", listed, re.MULTILINE)
        for command in [program] + [f"{program} {verb}" for verb in verbs]:
            names = re.findall(r"^  (--?[a-z0-9][^ ]*)", help_of(build, command), re.MULTILINE)
            found[command] = [name for both in names for name in both.split(",")]
    assert len(found) == 22 and sum(map(len, found.values())) > 350
    return found

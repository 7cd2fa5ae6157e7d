"""Every command has a man page that man sets without a warning and that has its options and sections.

    man_page_test.py BUILD         exit code 77: there is no man here
"""

import glob
import os
import re
import shutil
import subprocess
import sys

from commands import commands

SECTIONS = ["NAME", "SYNOPSIS", "DESCRIPTION", "OPTIONS", "EXAMPLE", "EXIT STATUS", "SEE ALSO"]
README = os.path.join(os.path.dirname(__file__), "../../README.md")


def set_page(page):
    """The page as text, and what man says of it."""
    environment = {**os.environ, "LC_ALL": "C.UTF-8", "MANWIDTH": "100"}
    done = subprocess.run(["man", "--warnings", "-l", page], capture_output=True, text=True, env=environment)
    return re.sub(".\b", "", done.stdout), done.stderr


def faults(build):
    with open(README) as file:
        codes = re.findall(r"^\| (\d+) \| ", file.read().partition("| exit code |")[2], re.MULTILINE)
    assert len(codes) == 7
    found = {page: None for page in glob.glob(f"{build}/manual/man1/*")}
    for command, options in commands(build).items():
        page = f"{build}/manual/man1/{command.replace(' ', '-')}.1.gz"
        if page not in found:
            yield f"{command} has no page"
            continue
        del found[page]
        text, warnings = set_page(page)
        if warnings:
            yield f"{page}: {warnings}"
        yield from (f"{page}: no {section}" for section in SECTIONS if f"\n{section}\n" not in text)
        entries = re.findall(r"^       (-.*)", text, re.MULTILINE)
        named = {word.rstrip(",") for entry in entries for word in entry.split()}
        yield from (f"{page}: no {option}" for option in options if option not in named)
        if re.findall(r"^       (\d+) ", text, re.MULTILINE) != codes:
            yield f"{page}: not the exit codes of README.md, {codes}"
    yield from (f"{page} is of no command" for page in found)


def main():
    if shutil.which("man") is None:
        print("man_page_test: no man here")
        return 77
    wrong = list(faults(sys.argv[1]))
    print("\n".join(wrong) or "all pages are in order")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())

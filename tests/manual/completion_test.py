"""What each shell makes of the TAB key: verbs, every option, words, files of the kind that is wanted.

    completion_test.py bash|zsh|fish BUILD

bash and zsh run on a terminal, as for a user, with programs in place of ours that say what they were given; fish
answers what it would offer. Exit code 77: the shell is not here.
"""

import os
import pty
import shlex
import shutil
import subprocess
import sys
import tempfile
import threading

from commands import commands

# What is typed, and the last argument after TAB.
CASES = [
    ("psf fil", "filter"),
    ("psf rec", "recover"),
    ("psf filter --nor", "--normal"),
    ("psf filter dump.pvb --quiet --visi", "--visibility"),
    ("psf filter --estimator ad", "adaptive"),
    ("psf filter --estimator=ad", "--estimator=adaptive"),
    ("psf filter --snapshots p", "pow2"),
    ("psf filter --gloss o", "off"),
    ("psf filter du", "dump.pvb"),
    ("psf filter --normal 0.9 du", "dump.pvb"),
    ("psf filter folder/in", "folder/inner.pvb"),
    ("psf info a\\ d", "a dump.pvb"),
    ("psf filter dump.pvb -o pict", "picture.exr"),  # not picture.pvb
    ("psf filter dump.pvb --json wi", "wide.txt"),
    ("psf cat dump.pvb du", "dump.pvb"),
    ("psf cat --codec z", "zstd"),
    ("psf compare --metric SS", "SSIM"),
    ("psf compare --colors tu", "turbo"),
    ("psf compare picture.exr pic", "picture.exr"),
    ("psf report fol", "folder"),
    ("psf-render --sam", "--sampler"),
    ("psf-render --sampler hal", "halton"),
    ("psf-render --sampler=hal", "--sampler=halton"),
    ("psf-render ro", "room.gltf"),
    ("psf-render room.gltf -o du", "dump.pvb"),
    ("psf-bench gr", "gr"),  # there is nothing
    ("psf-bench sw", "sweep"),
]
FILES = ["dump.pvb", "dump.txt", "a dump.pvb", "picture.exr", "picture.pvb", "room.gltf", "room.txt", "wide.txt",
         "folder/inner.pvb", "folder/inner.txt"]
PROGRAMS = ["psf", "psf-render", "psf-bench"]


def option_cases(build):
    """Every option of every command, typed but for its last letter."""
    cases = []
    for command, options in commands(build).items():
        for option in options:
            stem = option[:-1]
            if len(stem) > 3 and sum(other.startswith(stem) for other in options) == 1:
                cases.append((f"{command} {stem}", option))
    assert len(cases) > 180
    return cases


def prepare(folder):
    """Files to complete, and programs that write what they are given, an argument a line, to a pipe."""
    for name in FILES:
        os.makedirs(os.path.dirname(f"{folder}/{name}"), exist_ok=True)
        open(f"{folder}/{name}", "w").close()
    os.mkdir(f"{folder}/.bin")
    os.mkfifo(f"{folder}/.pipe")
    for program in PROGRAMS:
        with open(f"{folder}/.bin/{program}", "w") as file:
            file.write(f"#!/bin/sh\nprintf '%s\\n' \"$@\" >'{folder}/.pipe'\n")
        os.chmod(f"{folder}/.bin/{program}", 0o755)


def on_terminal(shell, start, typed, folder):
    """The last argument of each command after TAB and ENTER."""
    environment = {"HOME": folder, "PATH": f"{folder}/.bin:/usr/bin:/bin", "TERM": "vt100", "LC_ALL": "C.UTF-8"}
    pid, terminal = pty.fork()
    if pid == 0:
        os.chdir(folder)
        os.execve(shell[0], shell, environment)
    seen = bytearray()

    def drain():
        try:
            while data := os.read(terminal, 65536):
                seen.extend(data)
        except OSError:  # the shell has ended
            pass

    threading.Thread(target=drain, daemon=True).start()
    os.write(terminal, start.encode())
    given = []
    for line in typed:
        os.write(terminal, f"{line}\t\r".encode())
        with open(f"{folder}/.pipe") as pipe:  # waits for the program
            given.append(pipe.read().rstrip("\n").rpartition("\n")[2])
    os.write(terminal, b"exit\r")
    os.waitpid(pid, 0)
    return given


def by_fish(build, typed, folder):
    """The first of what fish offers for each command; what is typed, where it offers nothing."""
    script = "".join(f"source {build}/manual/fish/{program}.fish\n" for program in PROGRAMS)
    for line in typed:
        script += f"complete -C {shlex.quote(line)} | head -n 1; echo end\n"
    out = subprocess.run(["fish", "--no-config", "-c", script], check=True, capture_output=True, text=True, cwd=folder,
                         env={"HOME": folder, "PATH": f"{folder}/.bin:/usr/bin:/bin", "LC_ALL": "C.UTF-8"}).stdout
    offers = [offer.rstrip("\n").partition("\t")[0] for offer in out.split("end\n")[:-1]]
    return [offer or line.rpartition(" ")[2] for offer, line in zip(offers, typed, strict=True)]


def main():
    shell, build = sys.argv[1:]
    if shutil.which(shell) is None:
        print(f"completion_test: no {shell} here")
        return 77
    cases = CASES + option_cases(build)
    typed = [line for line, _ in cases]
    manual = f"{build}/manual"
    with tempfile.TemporaryDirectory() as folder:
        prepare(folder)
        if shell == "bash":
            start = "".join(f"source {manual}/bash/{program}\r" for program in PROGRAMS)
            given = on_terminal(["/bin/bash", "--norc", "--noprofile", "-i"], start, typed, folder)
        elif shell == "zsh":
            start = f"fpath=({manual}/zsh $fpath); autoload -U compinit; compinit -u -D\r"
            given = on_terminal(["/bin/zsh", "-f", "-i"], start, typed, folder)
        else:
            given = by_fish(build, typed, folder)
    given = [got.rstrip("/") for got in given]  # zsh takes it away again
    wrong = [f"{line}<TAB> gives '{got}', not '{wanted}'" for (line, wanted), got in zip(cases, given) if got != wanted]
    print("\n".join(wrong) or f"{shell} completes {len(cases)} commands")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())

"""nevh tests: the command, compiled steps, this module, sweeps and exported programs
take every scene that ships to the same state, bit for bit.

    same_states.py FOLDER, for the programs

SPDX-License-Identifier: GPL-3.0-or-later
"""

import os
import re
import shlex
import subprocess
import sys

sys.dont_write_bytecode = True
import nevh

STEPS = 40


def run(*arguments):
    done = subprocess.run(arguments, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          universal_newlines=True)
    assert done.returncode == 0, (arguments, done.stderr)
    return done.stdout


def rows_of(text):
    return [line.split(",") for line in text.splitlines() if line[:1] != "#"]


class Case:
    """The first steps of a scene by the first integrator that fits it."""

    def __init__(self, name):
        self.scene = nevh.Scene(name)
        settings = self.scene._settings()
        self.t0, self.name, self.n = settings.t_start, name, self.scene.n
        self.t_end = min(self.t0 + STEPS * settings.dt[0], settings.t_end)
        notes = run(nevh.command(), "run", name, "--t-end", repr(self.t_end),
                    "--samples", "2")
        word = next(line for line in notes.splitlines()
                    if line.startswith("# integrator: "))
        self.method = word.split()[2].rstrip(",:")

    def of_command(self, *more):
        rows = rows_of(run(nevh.command(), "run", self.name, "--integrators", self.method,
                           "--t-end", repr(self.t_end), "--samples", "2", "--quiet", *more))
        return [float(x) for x in rows[-1][1:1 + 2 * self.n]]

    def of_module(self):
        return list(nevh.solve(self.scene, (self.t0, self.t_end), method=self.method)
                    .y_reached)

    def of_program(self, folder):
        """None where the command says that there is no such program."""
        source, program = (os.path.join(folder, "x" + end) for end in (".c", ""))
        done = subprocess.run([nevh.command(), "export", self.name, "--integrators",
                               self.method, "--t-end", repr(self.t_end), "--every", "1000",
                               "-o", source], stderr=subprocess.PIPE)
        if done.returncode == 2:
            return None
        run(*shlex.split(os.environ.get("CC") or "cc"), "-std=c11", "-O2",
            "-ffp-contract=off", "-o", program, source, "-lm")
        return [float(x) for x in rows_of(run(program))[-1][1:1 + 2 * self.n]]


def sweep_of(case, folder):
    """The same start as an ensemble of two members, in place of the scene's."""
    path = os.path.join(folder, "alike.nevh")
    with open(case.scene.path, encoding="utf-8") as file:
        text = re.sub(r"^\[ensemble\].*\n(?:(?!\[).*\n)*", "", file.read(), flags=re.M)
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)
    name, start = case.scene.names[0], float(case.scene.start()[0])
    rows = rows_of(run(nevh.command(), "sweep", path, "--integrators", case.method,
                       "--t-end", repr(case.t_end), "--outcomes", "state", "--quiet",
                       "--vary", "%s = %r, %r" % (name, start, start)))
    assert rows[1][1] == rows[2][1] == "ok" and rows[1][2:] == rows[2][2:], rows
    return [float(x) for x in rows[1][3:3 + 2 * case.n]]


def main(folder):
    wrong = refused = 0
    for name in nevh.scenes():
        case = Case(name)
        expected = case.of_command("--native", "never")
        found = {"native": case.of_command("--native", "always"),
                 "module": case.of_module(), "sweep": sweep_of(case, folder)}
        for what, state in found.items():
            if state != expected:
                wrong += 1
                print("%s, %s, %s: %r, not %r" % (name, case.method, what, state, expected))
        exported = case.of_program(folder)
        refused += exported is None
        if exported not in (None, case.of_command("--portable", "--native", "never")):
            wrong += 1
            print("%s, %s, program: %r" % (name, case.method, exported))
    count = len(nevh.scenes())
    print("%d scenes, %d without a program, %d states that differ" % (count, refused, wrong))
    return wrong > 0 or refused > count // 3


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))

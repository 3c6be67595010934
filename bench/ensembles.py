"""What sweeps, sections and flow are promised to do: a row for each promise.

    python3 bench/ensembles.py NEVH [NEVH-MPI] [PART...]

The parts are flips, stopped, kills, same, memory, period, area and section; all of
them take some ten minutes of two cores that do nothing else.  It ends with exit
status 1 where a promise is not kept.  SIDE (1000), KILLS (30) and STOPPED (60 s)
make it shorter.  bench/speedup.sh measures threads and ranks.

SPDX-License-Identifier: GPL-3.0-or-later
"""

import csv
import math
import os
import random
import signal
import subprocess
import time

import promises
from promises import command, row, seconds, table, work

SIDE = int(os.environ.get("SIDE", 1000))
KILLS = int(os.environ.get("KILLS", 30))
STOPPED = float(os.environ.get("STOPPED", 60))


def bytes_of(name):
    with open(name, "rb") as file:
        return file.read()


def new(name):
    for old in (name, name + ".txt"):
        if os.path.exists(old):
            os.unlink(old)
    return name


def flips():
    """When a double pendulum, released at rest, first flips its second bob."""

    def map_of(side):
        return ["sweep", "double-pendulum", "--set", "g=1", "--t-end", "100",
                "--integrators", "rk4", "--dt", "0.05", "--gradient", "exact",
                "--vary", "phi1 = range(-pi, pi, %d)" % side,
                "--vary", "phi2 = range(-pi, pi, %d)" % side,
                "--outcomes", "first(abs(phi2) > pi)"]

    name = new(work + "/flips.csv")
    rate = SIDE * SIDE / seconds(*map_of(SIDE), "--threads", "2", "-o", name)
    forbidden = flipped = 0
    with open(name) as file:
        for member in csv.DictReader(line for line in file if line[0] != "#"):
            a, b = float(member["phi1"]), float(member["phi2"])
            if 2 * math.cos(a) + math.cos(b) > 1:
                forbidden += 1
                flipped += member["first(abs(phi2) > pi)"] not in ("", "nan")
    one = 100
    ratios = {}
    for native in "never", "always":
        begin = one * one / seconds(*map_of(one), "--threads", "1", "--width", "1",
                                    "--native", native)
        ratios[native] = rate / begin
    row("flip map %d x %d, members a second" % (SIDE, SIDE), "", "%.0f" % rate, True)
    row("  over a loop of single orbits", "20", "%.1f" % ratios["never"],
        ratios["never"] >= 20)
    row("  over such a loop with compiled steps", "", "%.1f" % ratios["always"], True)
    row("  flips where the energy forbids them", "0 of all", "%d of %d" % (
        flipped, forbidden), flipped == 0 and forbidden > SIDE)


LONG = ["sweep", "double-pendulum", "--vary", "phi1 = range(-3, 3, 20000)",
        "--t-end", "20", "--integrators", "gauss4", "--dt", "0.02", "--gradient",
        "exact", "--outcomes", "state"]


def whole():
    name = work + "/whole.npy"
    if not os.path.exists(name):
        command(*LONG, "-o", name)
    return bytes_of(name)


def ranks(count, *words):
    return subprocess.Popen(["mpirun", "-n", str(count), promises.mpi, *words,
                             "--quiet"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                            start_new_session=True)


def sweeps_of(pid):
    """The processes of the group of `pid` that run a sweep."""
    found = []
    for name in os.listdir("/proc"):
        try:
            if name.isdigit():
                with open("/proc/%s/cmdline" % name, "rb") as file:
                    program = file.read().split(b"\0")[0]
                if program.endswith(b"nevh-mpi") and descends(int(name), pid):
                    found.append(int(name))
        except OSError:
            pass
    return sorted(found)


def descends(pid, ancestor):
    while pid > 1:
        if pid == ancestor:
            return True
        with open("/proc/%d/stat" % pid) as file:
            pid = int(file.read().rpartition(")")[2].split()[1])
    return False


def stopped():
    """Three ranks on two cores, one of which is stopped for a minute."""
    if not promises.mpi:
        return
    expected, name = whole(), new(work + "/stopped.npy")
    begin = time.time()
    run = ranks(3, *LONG, "--threads", "1", "-o", name)
    while len(sweeps_of(run.pid)) < 3 or not os.path.exists(name):
        if run.poll() is not None:
            raise SystemExit("mpirun ended with status %d" % run.returncode)
        time.sleep(0.01)
    time.sleep(0.5)
    one = random.choice(sweeps_of(run.pid))
    os.kill(one, signal.SIGSTOP)
    time.sleep(STOPPED)
    os.kill(one, signal.SIGCONT)
    status = run.wait()
    same = os.path.exists(name) and bytes_of(name) == expected
    row("three ranks, one stopped for %g s" % STOPPED, "no member lost",
        "status %d, %s, %.0f s" % (status, "same bytes" if same else "others",
                                   time.time() - begin), same and status == 0)


def kills():
    """kill -9 at random moments, then --resume."""
    expected = whole()
    length = seconds(*LONG, "-o", new(work + "/length.npy"))
    for kind in ("process",) + (("rank",) if promises.mpi else ()):
        same = landed = 0
        for _ in range(KILLS // 2 if promises.mpi else KILLS):
            name = new(work + "/killed.npy")
            words = LONG + ["-o", name]
            run = (ranks(2, *words, "--threads", "1") if kind == "rank" else
                   subprocess.Popen([promises.nevh, *words, "--quiet"],
                                    stderr=subprocess.DEVNULL))
            time.sleep(random.uniform(0.02, length))
            try:
                if run.poll() is not None:
                    raise ProcessLookupError
                os.kill(random.choice(sweeps_of(run.pid)) if kind == "rank"
                        else run.pid, signal.SIGKILL)
                landed += 1
            except (IndexError, ProcessLookupError):
                pass
            run.wait()
            command(*LONG, "--resume" if os.path.exists(name) else "-o", name)
            same += bytes_of(name) == expected
        count = KILLS // 2 if promises.mpi else KILLS
        row("kill -9 of a %s, then --resume" % kind, "identical bytes",
            "%d of %d (%d hit)" % (same, count, landed), same == count)


def same():
    """The same bytes for widths, threads, parts and ranks."""
    expected, wrong, tried = whole(), [], 0

    def compare(name, what):
        nonlocal tried
        tried += 1
        if bytes_of(name) != expected:
            wrong.append(what)

    for width in 1, 8, 32:
        for threads in 1, 2:
            name = new(work + "/same.npy")
            command(*LONG, "--width", str(width), "--threads", str(threads), "-o", name)
            compare(name, "width %d, threads %d" % (width, threads))
    for parts in 1, 3, 16:
        name = new(work + "/same.npy")
        for part in range(parts, 0, -1):
            command(*LONG, "--task", "%d/%d" % (part, parts), "-o", name)
        if parts > 1 or not os.path.exists(name):
            command(*LONG, "--join", "-o", name)
        compare(name, "%d parts" % parts)
        for part in range(1, parts + 1):
            new(work + "/same.%d-of-%d.npy" % (part, parts))
    for count in (1, 2, 3) if promises.mpi else ():
        name = new(work + "/same.npy")
        ranks(count, *LONG, "--threads", "1", "-o", name).wait()
        compare(name, "%d ranks" % count)
    row("the same bytes for widths, threads, parts, ranks", "all",
        "%d of %d %s" % (tried - len(wrong), tried, "; ".join(wrong)), not wrong)


def memory():
    """Peak memory, and bytes a member on disk, for one outcome."""
    peaks = []
    for members in 10000, 100000, 1000000:
        name = new(work + "/memory.npy")
        run = subprocess.Popen([
            promises.nevh, "sweep", "pendulum", "--vary", "phi = range(0.1, 3, %d)" % members,
            "--t-end", "1", "--integrators", "verlet", "--dt", "0.1", "--outcomes",
            "max(p_phi)", "-o", name, "--quiet"])
        peak = 0
        while run.poll() is None:
            with open("/proc/%d/status" % run.pid) as file:
                peak = max([peak] + [int(line.split()[1]) for line in file
                                     if line.startswith("VmHWM")])
            time.sleep(0.001)
        peaks.append(peak)
    size = os.path.getsize(name) / members
    row("memory of 1e4, 1e5, 1e6 pendulums, MB", "the same",
        " ".join("%.1f" % (peak / 1024) for peak in peaks), peaks[2] < 1.5 * peaks[0])
    row("bytes of a member on disk", "64", "%.1f" % size, size < 64)


def period():
    """The pendulum's period against the complete elliptic integral."""

    def exact(amplitude):  # 2 pi/AGM(1, cos(amplitude/2)) sqrt(l/g)
        a, b = 1.0, math.cos(amplitude / 2)
        while abs(a - b) > 1e-15 * a:
            a, b = (a + b) / 2, math.sqrt(a * b)
        return 2 * math.pi / a / math.sqrt(9.8)

    members = [member for member in table("sweep", "pendulum-periods")
               if member.get("integrator", "gauss10") == "gauss10"]
    worst = max(abs(float(member["period"]) / exact(float(member["phi"])) - 1)
                for member in members)
    row("period against amplitude, %d amplitudes" % len(members), "1e-9",
        "%.1e" % worst, worst < 1e-9 and len(members) == 61)


def area():
    """The area of a disc after 1000 steps, and of a loop in two degrees of freedom."""
    h, g = 0.1, 9.8

    def factor(step):  # of the disc's area, by the determinants of all steps
        total, count, rings = 0.0, 0, 120
        for i in range(rings):
            radius = 0.3 * (i + 0.5) / rings
            for j in range(6 * i + 3):
                angle = 2 * math.pi * (j + 0.5) / (6 * i + 3)
                total += step(1 + radius * math.cos(angle), radius * math.sin(angle))
                count += 1
        return total / count

    def euler(q, p):
        product = 1.0
        for _ in range(1000):
            product *= 1 + h * h * g * math.cos(q)
            q, p = q + h * p, p - h * g * math.sin(q)
        return product

    def implicit(q, p):
        product = 1.0
        for _ in range(10):
            next_q = q + h * p
            for _ in range(60):
                next_q -= ((next_q - q - h * (p - h * g * math.sin(next_q)))
                           / (1 + h * h * g * math.cos(next_q)))
            q, p = next_q, p - h * g * math.sin(next_q)
            product /= 1 + h * h * g * math.cos(q)
        return product

    def ratio(scene, shape, integrator, *words):
        last = table("flow", scene, "--shape", shape, "--dt", "0.1", "--gradient",
                     "exact", "--integrators", integrator, *words)[-1]
        return float(last["ratio"]), last["status"]

    disc = "disc(phi = 1, p_phi = 0, 0.3)"
    loop = "loop(x = 0.15*cos(t), p_x = 0.3 + 0.1*sin(t), y = 0.05*sin(t))"
    schemes = ("verlet", "symplectic-euler-a", "midpoint", "gauss4", "gauss8",
               "blanes-moan4", "lobatto4")
    for scene, shape in ("pendulum", disc), ("henon-heiles", loop):
        worst = max(abs(ratio(scene, shape, name, "--at", "100")[0] - 1)
                    for name in schemes)
        row("area after 1000 steps, %s, %d schemes" % (scene, len(schemes)),
            "1 within 1e-9", "%.1e" % worst, worst < 1e-9)
    got, status = ratio("pendulum", disc, "euler", "--at", "100")
    theory = factor(euler)
    row("  Euler over theory, %s" % status, "1 within 0.01", "%.5f" % (got / theory),
        abs(got / theory - 1) < 0.01)
    got, status = ratio("pendulum", disc, "implicit-euler", "--at", "1")
    theory = factor(implicit)
    row("  implicit Euler over theory, 10 steps, %s" % status, "1 within 0.01",
        "%.5f" % (got / theory), abs(got / theory - 1) < 0.01)


def section():
    """Points of Henon and Heiles' section at E = 1/8 lie within its boundary."""
    points = table("section", "henon-heiles", "--integrators", "gauss8")
    outside = 0
    members = set()
    for point in points:
        y, p = float(point["y"]), float(point["p_y"])
        members.add(point.get("member"))
        outside += p * p / 2 + y * y / 2 - y ** 3 / 3 > 1 / 8 + 1e-9
    row("section at E = 1/8, %d members: points outside" % len(members), "0 of all",
        "%d of %d" % (outside, len(points)), outside == 0 and len(members) == 16)


PARTS = (flips, stopped, kills, same, memory, period, area, section)

if __name__ == "__main__":
    promises.main(__doc__, PARTS, takes_mpi=True)

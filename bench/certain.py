"""What references, exponents, maps and frequencies are promised to be: a row for each.

    python3 bench/certain.py NEVH [PART...]

The parts are states, scenes, exponents, pairs, frequencies and share; all of them take
some ten minutes of two cores that do nothing else.  It ends with exit status 1 where a
promise is not kept.  bench/brouwer.c measures rounding over a million periods, and
tests/diagnose/check_shadow.c asserts the slopes of shadow Hamiltonians.

SPDX-License-Identifier: GPL-3.0-or-later
"""

import csv
import glob
import math
import os
import re
import subprocess
import time
from decimal import Decimal, getcontext

import promises
from promises import command, row, table, work

getcontext().prec = 60

# Found by a Gauss method of order 16 in arithmetic of 113 bits, without nevh's code;
# Kepler 0.9 and the double pendulum to 20 digits.
STATES = {
    "pendulum": (100, 24, "q = 2", "p_q^2/2 - cos(q)",
                 "1.982325653157030515982941 0.1796407425909401978724921"),
    "oscillator": (100, 24, "q = 1", "(p_q^2 + q^2)/2",
                   "0.8623188722876839341019385 0.5063656411097587936565576"),
    "double pendulum": (
        10, 20, "q1 = pi/2\nq2 = 0",
        "(p_q1^2 + 2*p_q2^2 - 2*p_q1*p_q2*cos(q1 - q2))/(2*(1 + sin(q1 - q2)^2))"
        " - 9.8*(2*cos(q1) + cos(q2))",
        "0.1137118256716568201221664 -2.223609077492791711139523"
        " -3.802044137210631439898684 1.721351498235191875262862"),
    "Kepler 0.6": (100, 24, "x = 0.4\ny = 0\np_y = 2",
                   "(p_x^2 + p_y^2)/2 - 1/sqrt(x^2 + y^2)",
                   "-0.1041832044342322840550464 -0.6947417155679742850149844"
                   " 1.23617776268706369627367 0.564623251085780902059137"),
    "Kepler 0.9": (100, 20, "x = 1 - 0.9\ny = 0\np_y = sqrt((1 + 0.9)/(1 - 0.9))",
                   "(p_x^2 + p_y^2)/2 - 1/sqrt(x^2 + y^2)",
                   "-0.7506333330295163847347385 -0.4310000275773126803319831"
                   " 1.142347674435544008437918 0.07521912809634178298936333"),
    "Henon-Heiles": (100, 24, "x = 0\ny = 0.1\np_x = 0.49057789051960615",
                     "(p_x^2 + p_y^2 + x^2 + y^2)/2 + x^2*y - y^3/3",
                     "0.1329957183343852788967454 0.3760189573811590740470609"
                     " 0.2953954457827294417819349 -0.1606396034768338961890406"),
    "outer solar system": (
        1e5, 24,
        "x[1..6] = 0, -3.5023653, 9.0755314, 8.3101420, 11.4707666, -15.5387357\n"
        "y[1..6] = 0, -3.8169847, -3.0458353, -16.2901086, -25.7294829, -25.2225594\n"
        "z[1..6] = 0, -1.5507963, -1.6483708, -7.2521278, -10.8169456, -3.1902382\n"
        "p_x[i = 1..6] = m[i]*u[i]\np_y[i = 1..6] = m[i]*v[i]\np_z[i = 1..6] = m[i]*w[i]\n"
        "[parameters]\nG = 2.95912208286e-4\n"
        "m[1..6] = 1.00000597682, 0.000954786104043, 0.000285583733151,"
        " 0.0000437273164546, 0.0000517759138449, 1/1.3e8\n"
        "u[1..6] = 0, 0.00565429, 0.00168318, 0.00354178, 0.00288930, 0.00276725\n"
        "v[1..6] = 0, -0.00412490, 0.00483525, 0.00137102, 0.00114527, -0.00170702\n"
        "w[1..6] = 0, -0.00190589, 0.00192462, 0.00055029, 0.00039677, -0.00136504\n",
        "sum(i = 1..6, (p_x[i]^2 + p_y[i]^2 + p_z[i]^2)/(2*m[i]))"
        " - G*sum(i = 1..5, j = i+1..6, m[i]*m[j]"
        "/sqrt((x[i] - x[j])^2 + (y[i] - y[j])^2 + (z[i] - z[j])^2))",
        "0.6197224011858143216272708 -0.6106288694610207692516514 0.4154657294164806136767304"
        " 19.28017600753897417753974 -29.32441074107549684618195 14.12135343202440494682271"
        " -0.2483636156271377760225118 -5.007131633628507869589254 8.072758790294459409242097"
        " 6.371859337367577259512124 3.35566363371025127398574 -28.71152633143566508547563"
        " -0.1245068149012286598375582 -2.133588958789222417679572 3.325166069868792064696923"
        " 2.511511051876684488211745 2.096386578642025867813791 -13.07958855928588184700005"
        " 1.01749079352602288319858e-06 6.929673621889382917505871e-06 -1.6779076233638732187307e-06"
        " -6.234320287395418551160788e-08 -2.31200469481360437981481e-08 2.277524805648961117674917e-11"
        " -1.200251470970392554919066e-06 -1.16435159852500525247491e-06 -6.469943797736365656328389e-08"
        " 1.393273026014214002240993e-07 -1.483247854426252022274806e-07 6.830797024223976618475534e-12"
        " -6.067627579910039099424878e-07 -6.665994325864636938858454e-07 4.613166587113910613817603e-08"
        " 6.1890815527705011017908e-08 -6.013736049178447400991621e-08 -4.719666677169497642915039e-12"),
}


def digits(known, found):
    """How many leading digits two decimal numbers share, one unit allowed."""
    scale = 10.0 ** math.floor(math.log10(abs(float(known))))
    whole = [int(round_to(text, scale)) for text in (known, found)]
    apart = abs(whole[0] - whole[1])
    return 30 if apart == 0 else int(29 - math.log10(apart))


def round_to(text, scale):
    return (Decimal(text) / Decimal(scale) * Decimal(10) ** 29).to_integral_value()


def states():
    """States of the literature's problems, at their own end times."""
    for name, (t, wanted, start, formula, known) in STATES.items():
        scene = os.path.join(work, "state.nevh")
        with open(scene, "w") as file:
            file.write("[coordinates]\n%s\n[effects]\nH = %s\n" % (start, formula))
        times = []
        for _ in range(3):
            begin = time.time()
            table("reference", scene, "--at", str(t))
            times.append(time.time() - begin)
        lines = table("reference", scene, "--at", str(t), "--digits", "30")
        least = min(digits(k, list(line.values())[2])
                    for k, line in zip(known.split(), lines))
        row("state of %s at t = %g: digits" % (name, t), "%d" % wanted, "%d" % least,
            least >= wanted)
        row("  seconds, median of 3", "0.3", "%.3f" % sorted(times)[1],
            sorted(times)[1] <= 0.3)


def scenes():
    """The own error of each scene's reference, at the end of its run."""
    worst, horizons, other = 0.0, [], []
    names = sorted(glob.glob(os.path.join(os.environ["NEVH_SCENES"], "*.nevh")))
    for name in names:
        done = subprocess.run([promises.nevh, "compare", name, "--integrators",
                               "midpoint"], capture_output=True, text=True)
        text = re.sub(r"\s+", " ", done.stdout)
        scene = os.path.basename(name)[:-5]
        own = re.search(r"own error ([0-9.e-]+)", text)
        if "predictability horizon" in text:
            horizons.append(scene)
        elif "state error: largest difference" in text:
            worst = max(worst, float(own.group(1)) if own else 1e-15)
        else:
            other.append(scene)
    row("largest own error of %d scenes" % (len(names) - len(horizons) - len(other)),
        "1e-15", "%.1e" % worst, worst <= 1.05e-15)
    print("  to a horizon: %s; without: %s" % (" ".join(horizons) or "none",
                                               " ".join(other) or "none"))


HENON_HEILES = "p_x=sqrt(2*(%s - y^2/2 + y^3/3))"
DOUBLE = ["double-pendulum", "--integrators", "gauss6", "--dt", "0.02"]
# Known by an independent program, with its error.
EXPONENTS = [
    ("Henon-Heiles 1/8, y = -0.1", "henon-heiles", "-0.1", "1/8", 0.045, 0.002, 1e5),
    ("Henon-Heiles 1/8, y = -0.15", "henon-heiles", "-0.15", "1/8", 0.045, 0.002, 1e5),
    ("Henon-Heiles 1/8, y = -0.25", "henon-heiles", "-0.25", "1/8", 0.045, 0.002, 1e5),
    ("Henon-Heiles 1/6, y = -0.1", "henon-heiles", "-0.1", "1/6", 0.122, 0.003, 1e5),
    ("Henon-Heiles 1/8, y = 0.1, regular", "henon-heiles", "0.1", "1/8", 0, 0, 1e4),
    ("  ten times as long", "henon-heiles", "0.1", "1/8", 0, 0, 1e5),
    ("double pendulum from rest at (3, 3)", "double", "phi1=3,phi2=3", None,
     1.03, 0.02, 2000),
    ("double pendulum, p = (0, 3.873)", "double", "phi1=0,phi2=0,p_phi1=0,p_phi2=3.873",
     None, 0.145, 0.011, 4000),
]


def start_of(y, energy):
    momentum = math.sqrt(2 * (eval(energy) - float(y) ** 2 / 2 + float(y) ** 3 / 3))
    return "y=%s,p_y=0,p_x=%.17g" % (y, momentum)


def chaos_of(scene, start, energy, t_end, *more):
    if scene == "double":
        return table("chaos", *DOUBLE, "--start", start, "--t-end", "%g" % t_end, *more)
    return table("chaos", scene, "--integrators", "blanes-moan4", "--dt", "0.2",
                 "--start", start_of(start, energy), "--t-end", "%g" % t_end, *more)


def exponents():
    for name, scene, start, energy, known, error, t_end in EXPONENTS:
        begin = time.time()
        line = chaos_of(scene, start, energy, t_end)[0]
        value, own = float(line["value"]), float(line["error"])
        bar = 2 * math.hypot(own, error)
        row(name, "%.3f(%.0f)" % (known, 1e3 * error),
            "%.5f(%.5f) %s, %.0f s" % (value, own, line["verdict"],
                                       time.time() - begin),
            abs(value - known) <= bar)


def pairs():
    """Exponents of a Hamiltonian system come in pairs of opposite sign."""
    for name, scene, start, energy, _, _, t_end in EXPONENTS[1::5]:
        value = [float(line["value"]) for line in chaos_of(
            scene, start, energy, t_end, "--exponents", "all", "--starts", "1")]
        worst = max(abs(a + b) for a, b in zip(value, reversed(value)))
        row("pairs of %s" % name, "1e-3", "%.1e" % worst, worst <= 1e-3)


def frequencies():
    def lines(scene, *more):
        return [float(line["frequency"])
                for line in table("frequencies", scene, *more)]

    a, b = 1.0, math.cos(1.0)  # 2 rad
    while abs(a - b) > 1e-15:
        a, b = (a + b) / 2, math.sqrt(a * b)
    exact = math.sqrt(9.8) * a
    found = lines("pendulum", "--integrators", "gauss8", "--dt", "0.01")[0]
    row("frequency of the pendulum over the exact one", "1e-12",
        "%.1e" % abs(found / exact - 1), abs(found / exact - 1) <= 1e-12)
    first, second = (lines("henon-heiles", "--start", start_of("0.1", "1/12"),
                           "--t-end", "2000", "--integrators", name, "--dt", step,
                           "--gradient", "exact")
                     for name, step in (("gauss16", "0.1"), ("blanes-moan6", "0.02")))
    apart = max(abs(x / y - 1) for x, y in zip(first[:2], second[:2]))
    row("Henon-Heiles' torus by two schemes", "1e-10", "%.1e" % apart, apart <= 1e-10)


def share():
    """A map of SALI, and the share of chaos beside Figure 7 of Henon and Heiles."""
    for energy, known in ("1/12", 0.0), ("1/8", 0.5), ("1/6", 1.0):
        side = 400
        begin = time.time()
        command("sweep", "henon-heiles", "--vary",
                "y = range(-0.55, 1, %d)" % side, "--vary",
                "p_y = range(-0.6, 0.6, %d)" % side, "--vary",
                "p_x = solve(H = %s, from 0.4)" % energy, "--outcomes", "sali",
                "--integrators", "forest-ruth", "--t-end", "1000",
                "--picture", os.path.join(work, "map.png"), "-o",
                os.path.join(work, "map.csv"), allowed=(0, 1))
        found = read_map()
        taken = time.time() - begin
        there = [line for line in found if line["status"] == "ok"]
        chaotic = sum(float(line["sali"]) < 1e-8 for line in there)
        part = chaotic / len(there)
        row("map of SALI at E = %s, %d x %d, seconds" % (energy, side, side), "120",
            "%.0f" % taken, taken <= 120)
        row("  share of chaos of %d orbits; Figure 7" % len(there), "%.1f" % known,
            "%.3f" % part, abs(part - known) <= 0.1)


def read_map():
    with open(os.path.join(work, "map.csv")) as file:
        return list(csv.DictReader(line for line in file if line[0] != "#"))


PARTS = (states, scenes, exponents, pairs, frequencies, share)

if __name__ == "__main__":
    promises.main(__doc__, PARTS)

# What a constant is, in 60 digits, and what nevh reference makes of each way to
# write it.  KIND is what it stands for: a spring, behind a minus or as a
# parameter, a start, a velocity, a mass, an exponent, a drive, a friction or a
# time.  No output: no digit is false.
#   python3 constants.py NEVH FOLDER KIND
import subprocess
import sys
from decimal import Decimal, getcontext

getcontext().prec = 70


def d(x):
    return Decimal(float(x))  # a number that is written is a double


def series(x, parity, sign):
    turns = (x / (2 * PI)).to_integral_value() if sign < 0 else 0
    x -= 2 * PI * turns
    term, total, k = (x if parity else Decimal(1)), Decimal(0), parity
    while abs(term) > Decimal(10) ** -68 or k < abs(x):
        total += term
        term *= sign * x * x / ((k + 1) * (k + 2))
        k += 2
    return total


def arctan(x):
    if x < 0:
        return -arctan(-x)
    if x > Decimal("0.1"):  # of half the angle
        return 2 * arctan(x / (1 + (1 + x * x).sqrt()))
    term, total, k = x, Decimal(0), 1
    while abs(term) > Decimal(10) ** -68:
        total += term / k
        term *= -x * x
        k += 2
    return total


PI = 16 * arctan(1 / Decimal(5)) - 4 * arctan(1 / Decimal(239))


def sin(x):
    return series(x, 1, -1)


def cos(x):
    return series(x, 0, -1)


def bessel(n, x):
    term = (x / 2) ** n
    total, k = Decimal(0), 1
    while abs(term) > Decimal(10) ** -68:
        total += term
        term *= -x * x / (4 * k * (k + n))
        k += 1
    return total


def elliptic(k, second):
    a, g, total, power = Decimal(1), (1 - k * k).sqrt(), k * k / 2, Decimal(1)
    while abs(a - g) > Decimal(10) ** -66:
        c = (a - g) / 2
        a, g = (a + g) / 2, (a * g).sqrt()
        total += power * c * c
        power *= 2
    return PI / (2 * a) * (1 - total if second else 1)


def eccentric(m, e):
    x = m
    for _ in range(100):
        x -= (x - e * sin(x) - m) / (1 - e * cos(x))
    return x


one, third = Decimal(1), 1 / Decimal(3)
a, b, mu = d(0.7), d(2.3), d(0.1)
HEAD = """[parameters]
a = 0.7
b = 2.3
mu = 0.1
A = 1/3
B = A^2*pi
c[1..3] = 0.3, 0.6, 1/7
k[i = 1..3] = i/3
S = 1
"""
WAYS = [
    ("-(1-mu)*(-1)", 1 - mu), ("1/3", third), ("-(-(1/3))", third),
    ("sqrt(2)", d(2).sqrt()), ("-(-sqrt(2))", d(2).sqrt()),
    ("-(-a^2)", a * a), ("a^2", a * a), ("a*b", a * b), ("a/b", a / b),
    ("a+b", a + b), ("exp(1)", one.exp()), ("exp(a)", a.exp()), ("pi", PI),
    ("-(-pi)", PI), ("pi^2", PI * PI), ("cos(1)", cos(one)),
    ("sin(pi/3)", sin(PI / 3)), ("tan(a)", sin(a) / cos(a)),
    ("log(3)", d(3).ln()), ("log10(3)", d(3).log10()),
    ("atan2(1, a)", arctan(1 / a)), ("asin(a)", arctan(a / (1 - a * a).sqrt())),
    ("acos(mu)", PI / 2 - arctan(mu / (1 - mu * mu).sqrt())),
    ("sinh(a)", (a.exp() - (-a).exp()) / 2),
    ("atanh(a)", ((1 + a) / (1 - a)).ln() / 2),
    ("acosh(b)", (b + (b * b - 1).sqrt()).ln()),
    ("hypot(a, b)", (a * a + b * b).sqrt()), ("cbrt(2)", d(2) ** third),
    ("2^(1/3)", d(2) ** third), ("a^b", a ** b), ("pow(a, 1/7)", a ** (one / 7)),
    ("max(1/3, 0.2)", third), ("min(a/3, 1)", a / 3), ("abs(-1/3)", third),
    ("sign(2)/3", third), ("mod(7/3, 1)", third), ("mod(-7/3, 1)", 2 * third),
    ("floor(2.5)/3", 2 * third), ("bessel_j0(0.5)", bessel(0, d(0.5))),
    ("bessel_j1(1.5)", bessel(1, d(1.5))),
    ("elliptic_k(0.5)", elliptic(d(0.5), False)),
    ("elliptic_e(0.5)", elliptic(d(0.5), True)),
    ("kepler(1, 0.5)", eccentric(one, d(0.5))), ("A", third), ("-(-A)", third),
    ("B", third * third * PI), ("c[3]", one / 7), ("k[2]*a", 2 * third * a),
    ("sum(i = 1..3, c[i])", d(0.3) + d(0.6) + one / 7),
    ("sum(i = 1..3, k[i]^2/i)", sum((d(i) / 3) ** 2 / i for i in (1, 2, 3))),
    ("D", d(3).sqrt() / 3), ("-(1-D)*(-1)", 1 - d(3).sqrt() / 3),
    ("S", third), ("-(-S^2)", third * third), ("0.1", mu), ("-(-0.1)", mu),
    ("1/3 + pi/7", third + PI / 7),
]  # yapf: disable


def spring(w, t):
    return cos(w.sqrt() * t), -w.sqrt() * sin(w.sqrt() * t)


def damped(w, t):
    rate = (1 - w * w / 4).sqrt()
    fall = (-w * t / 2).exp()
    p = -fall * sin(rate * t) / rate
    return fall * (cos(rate * t) + w / 2 * sin(rate * t) / rate), p


# Lines of parameters, coordinates and friction, T, V; the state at t.
KINDS = {
    "spring": ("", "x{i} = 1", "", "p_x{i}^2/2", "({w})*x{i}^2/2", spring),
    "minus": ("", "x{i} = 1", "", "p_x{i}^2/2", "-(-({w}))*x{i}^2/2", spring),
    "factor": ("", "x{i} = 1", "", "p_x{i}^2/2", "-({w})*(1 - x{i}^2)/2",
               spring),
    "parameter": ("w{i} = {w}", "x{i} = 1", "", "p_x{i}^2/2", "w{i}*x{i}^2/2",
                  spring),
    "start": ("", "x{i} = {w}", "", "p_x{i}^2/2", "x{i}^2/2", lambda w, t:
              (w * cos(t), -w * sin(t))),
    "velocity": ("", "x{i} = 0\nv_x{i} = {w}", "", "3*p_x{i}^2/2",
                 "x{i}^2/6", lambda w, t: (w * sin(t), w * cos(t) / 3)),
    "mass": ("", "x{i} = 1", "", "p_x{i}^2/(2*({w}))", "x{i}^2/(2*({w}))",
             lambda w, t: (cos(t / w), -sin(t / w))),
    "exponent": ("", "x{i} = 1", "", "p_x{i}", "x{i}^({w})", lambda w, t:
                 (1 + t, 1 - (1 + t) ** w)),
    "drive": ("", "x{i} = 0", "", "p_x{i}^2/2", "-x{i}*cos(({w})*t)",
              lambda w, t: ((1 - cos(w * t)) / w ** 2, sin(w * t) / w)),
    "friction": ("", "x{i} = 1", "f{i} = x{i}: {w}", "p_x{i}^2/2", "x{i}^2/2",
                 damped),
    "time": ("", "x{i} = 1", "", "p_x{i}^2/2", "x{i}^2/2", lambda w, t:
             (cos(w), -sin(w))),
}


def scene(kind, ways):
    def lines(text):
        return "\n".join(text.format(i=i, w=w) for i, (w, _) in ways) + "\n"

    parameters, coordinates, friction, t, v, _ = KINDS[kind]
    terms = "\n".join("%s{i} = %s" % (n, f) for n, f in (("T", t), ("V", v)))
    return (HEAD + (lines(parameters) if parameters else "") +
            "[coordinates]\n" + lines(coordinates) +
            "[definitions]\nD = sqrt(3)/3\n[effects]\n" + lines(terms) +
            ("[friction]\n" + lines(friction) if friction else ""))


def run(nevh, path, at, digits):
    out = subprocess.run(
        nevh.split() + ["reference", path, "--set", "S = 1/3", "--at", at,
                        "--digits", str(digits), "--format", "csv", "--quiet"],
        check=True, capture_output=True, text=True).stdout
    return [line.split(",") for line in out.splitlines()[1:]]


def check(kind, rows, truth, digits):
    enough = sum(abs(x) < Decimal("1e-6") for x in truth)  # near 0: fewer
    for row, x in zip(rows, truth):
        if int(row[3]) == 0:
            continue
        found = Decimal(row[2])
        last = Decimal(10) ** (found.adjusted() - int(row[3]) + 1)
        enough += int(row[3]) >= digits - 4
        if abs(found - x) > 2 * last:
            print(kind, row, "%.36s" % x)
    if enough < 0.9 * len(truth):
        print(kind, "has too few digits:", enough, "of", len(truth))


def main(nevh, folder, kind):
    path = folder + "/constants.nevh"
    ways = list(enumerate(WAYS))
    exact = KINDS[kind][5]
    if kind in ("start", "velocity", "parameter", "time"):
        # No definition stands there.
        ways = [(i, w) for i, w in ways if "D" not in w[0]]
    if kind == "friction":  # of oscillations
        ways = [(i, w) for i, w in ways if w[1] < 2]
    with open(path, "w") as f:
        f.write(scene(kind, ways[:1] if kind == "time" else ways))
    if kind == "time":
        for _, (w, value) in ways:
            check(w, run(nevh, path, w, 24), exact(value, None), 24)
        return
    for t, digits in (("3", 30), ("30", 24)):
        truth = [exact(w, d(t)) for _, (_, w) in ways]
        check(kind, run(nevh, path, t, digits),
              [x for x, _ in truth] + [p for _, p in truth], digits)


main(*sys.argv[1:])

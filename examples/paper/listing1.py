"""Listing 1 of the paper, the harmonic oscillator of period 1.  Only the first line
differs: nevh.solve takes the place of SciPy's solve_ivp, and H is traced, so that the
orbit is that of a formula.  What to look for: after 3000 periods the energy has changed by
some 1e-7 only, in a few milliseconds."""
from nevh import solve as solve_ivp
import nevh
PI = 3.141592653589793

# Hamiltonian function
def H(t, s, k, m):
    x, p = s
    return 0.5 * k * x**2 + 0.5 * p**2 / m

# Initial state: off equilibrium position, at rest (x=1, p=0)
initial_state = [1.0, 0.0]
# Discretization step parameters for numerical derivatives
ds = [0.1, 0.1]
# Hamiltonian parameters. With k=4\pi^2, m=1, the period is 1
kc = 4 * PI**2
mc = 1.0

# Create the HGrad object, use scipy.solve_ivp to
G = nevh.HGrad(H, ds, k=kc, m=mc)

# solve Halmilton's eqs numerically from t=0 to t=3
trj = solve_ivp(G, [0.0, 3.0], initial_state)

# The same until t = 3000.
long = solve_ivp(G, [0.0, 3000.0], initial_state)
for orbit in (trj, long):
    print("t = %g: x = %.6f, p = %.6f, largest energy error %.1e" % (
        orbit.t[-1], orbit.y[0][-1], orbit.y[1][-1], orbit.energy_error))

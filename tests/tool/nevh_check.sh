#!/bin/sh
# nevh check: what is said before a run.

. "${srcdir:-.}/tests/support/nevh_support.sh"

# A pendulum with w = 1 at most; dt = 0.1 and 2.5 against the limits.
exits 0 check pendulum --dt 0.1 --format csv
has '^# Highest frequency: omega = 3\.13 rad/s \(t = .* s\); omega dt = 0\.313 at dt = 0\.1 s$'
exits 0 check pendulum --dt 0.1 --all
has '^ verlet +2 +yes +2 +0\.313$'
has '^ euler +1 +yes +never +0\.313 +unstable: amplitude times 2\.56 a period'
# |R(iy)| > 1 for every y: (1 + 0.313^4/4)^(pi/0.313).
has '^ heun +2 +yes +never +0\.313 +unstable: amplitude \+2\.4 % a period'
has '^ gsl-rkf45 +5 +yes +never '
exits 0 check "$srcdir/scenes/hard/elastic-pendulum.nevh" --dt 0.05 --t-end 5 --all
has '^Highest frequency: omega = 100 '
has '^ verlet +2 +yes +2 +5 +unstable'
has '^ gauss4 +4 +yes +any step +5 +not resolved'
exits 0 check "$srcdir/scenes/hard/elastic-pendulum.nevh" --dt 0.005 --t-end 1 --all
has '^ verlet +2 +yes +2 +0.5$'

# x^4/24, of numbers that cancel in the derivative too, and as it is; x^2/2, of numbers
# that do not change with the last digits of x.
for v in '1e20*(cos(1e-5*x) - 1 + (1e-5*x)^2/2)' 'x^4/24' \
    '1e22*(exp(1e-11*x) - 1 - 1e-11*x)' '1 - cos(x)'; do
    printf '[coordinates]\nx = 1\n[effects]\nK = p_x^2/2\nV = %s\n[run]\nt_end = 20
dt = 0.01\nintegrators = verlet\n' "$v" >$work/cancel.nevh
    exits 0 check $work/cancel.nevh --gradient exact --format csv
    case $v in
    1e2*)
        has '^# Gradient: .* cancel, .* exact gradient by [0-9.]+e-0[56] of the largest'
        lacks '^# Gradient: exact adds no rounding'
        ;;
    *)
        lacks ' cancel, '
        has '^# Gradient: exact adds no rounding'
        ;;
    esac
done

# A derivative that is far below others is lost in their rounding, where a term connects them.
for more in '' ' + 1e-20*x*y'; do
    printf '[coordinates]\nx = 1e-12\ny = 1e4\n[effects]\nK = (p_x^2 + p_y^2)/2
V = (x^2 + y^2)/2%s\n[run]\nt_end = 20\ndt = 0.01\nintegrators = verlet\n' "$more" >$work/far.nevh
    exits 0 check $work/far.nevh --format csv
    case $more in
    '') lacks ' of the largest dH/d' ;;
    *) has '^# Gradient: central4 errs by [0-9.e-]+ of the largest dH/dx' ;;
    esac
done

# A wall over a hundredth of the length that differences are made for: central4 is off
# by a part of the force, not by rounding.  Contrast: a softer wall, exact gradients.
printf '[coordinates]\nx = 1\n[effects]\nK = p_x^2/2\nV = x + 1e-12/x^12\n[run]\nt_end = 200
dt = 0.01\nintegrators = verlet\n' >$work/wall.nevh
exits 0 check $work/wall.nevh --format csv
has '^# Gradient: central4 errs by [0-9.]+e-0[12] of the largest derivative .* shorter lengths'
lacks '^# Gradient: the rounding'
exits 0 check $work/wall.nevh --gradient exact --format csv
lacks ' errs by '
sed 's/1e-12/1/' $work/wall.nevh >$work/soft.nevh
exits 0 check $work/soft.nevh --format csv
lacks ' errs by '

# What differs between machines is named: of effects that are on, of values, and of
# schemes.  Contrast: nevh's own functions, and an effect that is off.
printf '[parameters]\na = elliptic_k(0.5)\n[coordinates]\nx = 1\n[effects]\nK = p_x^2/2
V = a*x^2/2\nW = 0.1*bessel_j0(x)\n[run]\nt_end = 1\ndt = 0.1\nintegrators = verlet, gsl-rk8pd\n' \
    >$work/library.nevh
digits='^# Last digits may differ between machines: '
exits 0 check $work/library.nevh --format csv
has "${digits}.*bessel_j0, elliptic_k, gsl-rk8pd"
exits 0 check $work/library.nevh --without W --integrators verlet --format csv
has "${digits}.*elliptic_k"
lacks "${digits}.*(bessel_j0|gsl-)"
exits 0 run $work/library.nevh --without W --integrators verlet
has "${digits}.*elliptic_k"
sed 's/elliptic_k(0.5)/kepler(1, 0.5)/; s/bessel_j0/abs/' $work/library.nevh >$work/own.nevh
exits 0 check $work/own.nevh --integrators verlet,gauss4,taylor --format csv
lacks "$digits"
exits 0 run $work/own.nevh --integrators taylor --without W --tolerance 1e-17
has "${digits}taylor "
exits 0 check kirkwood-gap --format csv
has "${digits}aba864, wisdom-holman "

# Steps that are too short round: not a matter of lengths.
exits 0 check pendulum --gradient-step 1e-10 --format csv
has '^# Gradient: central4 errs by [0-9.]+e-0[5-7] of the largest derivative .* rounding of H'
lacks 'shorter lengths'

# A well that lies between all states that are tried is no quadratic form: nothing is
# exact about it.  Contrast: the spring alone.
printf '[coordinates]\nx = 0.5\n[effects]\nK = p_x^2/2\nV = x^2/2 - 0.01*exp(-((x - 0.37)/1e-5)^2)
[run]\nt_end = 20\ndt = 0.001\nintegrators = verlet\n' >$work/well.nevh
exits 0 check $work/well.nevh --format csv
lacks 'B is 0'
exits 0 compare $work/well.nevh --format csv
lacks 'cosine'
sed 's/ - 0.01.*//' $work/well.nevh >$work/spring.nevh
exits 0 check $work/spring.nevh --format csv
has 'B is 0'
exits 0 compare $work/spring.nevh --format csv
has 'cosine'

# The table holds the integrators that are to run; the others are named.
exits 0 check pendulum --integrators verlet,gauss4
test $(grep -c '^ [a-z].* yes ' $work/out) = 2 || fails "has other rows"
has '^Also fit \(--all shows them\): symplectic-euler-a, '
has '^stable below: '
exits 0 check double-pendulum
has '^Do not fit: symplectic-euler-a, .*verlet'
exits 0 check pendulum --format csv --quiet
test $(wc -l <$work/out) -ge 40 || fails "leaves out rows"

# Chaotic, regular, or too short to tell.  Exponents of this orbit from runs of
# 400 and of 4000 seconds agree.
exits 0 check double-pendulum --format csv
has '^# Chaotic: Lyapunov exponent 0\.2[0-9]* \+- [0-9.]+/s .* Predictability horizon: about t = 1[5-7][0-9] s \([0-9.]+ to [0-9.]+, '
exits 0 check double-pendulum --t-end 100 --format csv
has '^# Chaotic: Lyapunov exponent 0\.[12].* Predictability horizon: beyond the run, about t = [0-9]+ s '
exits 0 check double-pendulum --t-end 10
has '^Chaotic or regular: 10 s are too short to decide'
exits 0 check double-pendulum --start phi1=0.1,phi2=0.1
has '^Regular: '
exits 0 check pendulum
has '^Regular: one degree of freedom'
# Neighbours of these part in proportion to the time, which is no chaos.
for scene in kepler kepler-0.9 figure-eight henon-heiles \
    double-pendulum-regular coupled-pendulums; do
    exits 0 check $scene
    has '^Regular: over '
    lacks 'Chaotic'
done
for scene in double-pendulum-chaotic damped-driven-pendulum; do
    exits 0 check $scene
    has '^Chaotic: '
done
exits 0 check "$srcdir/scenes/hard/double-pendulum.nevh" --t-end 1000
lacks 'Chaotic: '
printf '%s\n' 's/^phi = .*/phi = 0/' 's/^p2 = .*/p2 = 3.873/' >$work/edit
sed -f $work/edit "$srcdir/scenes/hard/double-pendulum.nevh" >$work/chaos.nevh
exits 0 check $work/chaos.nevh --t-end 1000 --format csv
has '^# Chaotic: .* about t = [0-9]+'

# The floor of the gradient, and where H ends.
exits 0 check pendulum --dt 0.1
has '^Gradient: .* energy error of [0-9.]+e-[0-9]+'
exits 0 check "$srcdir/scenes/hard/edge.nevh" --t-end 0.1
has '^The domain of H ends at x = '
exits 0 check pendulum
lacks 'domain of H ends'
exits 0 check pendulum --format json
if command -v python3 >/dev/null 2>&1; then
    python3 -m json.tool $work/out >/dev/null || fails "is no JSON"
fi

# Where neighbours part because the orbit itself moves away there is no chaos: a
# saddle, which is linear, and parametric resonance, whose exponent Floquet's
# theory gives as 0.0748.
printf '%s\n' '[coordinates]' 'x = 0.01' 'y = 1' '[effects]' \
    'kinetic = (p_x^2 + p_y^2)/2' 'saddle = -x^2/8 + 2*y^2' '[run]' 'dt = 0.05' \
    't_end = 30' >$work/saddle.nevh
for t_end in 30 100 300; do
    exits 0 check $work/saddle.nevh --t-end $t_end
    has '^Unstable, not chaotic: '
    has 'exponent about 0\.(49|5)'
    lacks 'Chaotic'
done
printf '%s\n' '[coordinates]' 'x = 0.1' '[effects]' 'kinetic = p_x^2/2' \
    'spring = (1 + 0.3*cos(2*t))*x^2/2' '[run]' 'dt = 0.05' 't_end = 200' >$work/pumped.nevh
for t_end in 200 300 1000; do
    exits 0 check $work/pumped.nevh --t-end $t_end
    has '^Unstable, not chaotic: '
    has 'exponent about 0\.07'
done
# Differences of momenta of 1e29 kg m/s.
printf '%s\n' '[parameters]' 'G = 6.6743e-11' 'M = 1.98892e30' 'm = 5.9722e24' \
    '[coordinates]' 'x, y, z = elements(1.495978707e11, 0.0167, 0.01, 0.3, 0.5, 0.1, G*M)' \
    '[effects]' 'kinetic = (p_x^2 + p_y^2 + p_z^2)/(2*m)' \
    'gravity = -G*M*m/sqrt(x^2 + y^2 + z^2)' '[run]' 't_end = 3e8' 'dt = 86400' >$work/si.nevh
exits 0 check $work/si.nevh
lacks 'dprkn12: '

# What grows is no frequency: a pendulum upside down, and a hill alone.
printf '%s\n' '[coordinates]' 'x = 1e-6' '[effects]' 'K = p_x^2/2' 'V = -x^2/2' \
    '[run]' 't_end = 3' 'dt = 0.1' 'integrators = verlet' >$work/hill.nevh
exits 0 check $work/hill.nevh
lacks '^Highest frequency'
has '^Fastest growth: small displacements grow at a rate of 1 '
has '^ verlet +2 +yes +2$'

# Numbers near the largest there are.
sed -e 's/= p_x/= 1e300*p_x/' -e 's/= -x/= 1e300*x/' -e 's/1e-6/1/' $work/hill.nevh \
    >$work/huge.nevh
exits 0 check $work/huge.nevh
has '^Highest frequency: omega = 1e\+300 '
lacks '[^a-z](inf|nan)'

# A kink that differences beside the start do not reach is met by a Taylor series.
for case in '(x^2)^1.5:no' 'x^2/2 + asin(sin(x)):no' 'sqrt(1 + x^2):yes' \
    'abs(x)^3:no' 'x^2/2 + max(x - 1, 0)^3:no' 'x^2/2 + max(-x, 0)^2.5:no' \
    'x^2/2 + max(x - 9, 0)^2.5:yes' 'abs(x)^4:yes' 'x^2/2 + abs(x + 9):yes'; do
    printf '[coordinates]\nx = 1, 1.5\n[effects]\nT = p_x^2/2\nV = %s\n[run]\nt_end = 10\ndt = 0.1\nintegrators = verlet\n' \
        "${case%:*}" >$work/kink.nevh
    exits 0 check $work/kink.nevh
    has "^  smooth  *${case##*:} "
    test ${case##*:} = yes || has 'in effect "V" is not analytic there'
    exits 0 check $work/kink.nevh --format csv
    case ${case##*:} in
    yes) lacks 'differences err more' ;;
    no) has '^# Gradient: .*; its differences err more where they reach across' ;;
    esac
done

# A start at the kink of |x|^3, whose differences of order 2 look smooth.  The table
# says so, and the errors that are estimated hold along the orbit.
printf '%s\n' '[coordinates]' 'x = 0' '[effects]' 'T = p_x^2/2' \
    'V = abs(x)^3 - 0.3*x*cos(t)' '[run]' 't_end = 20' 'dt = 0.01' >$work/kink.nevh
exits 0 check $work/kink.nevh --integrators verlet
has '^  smooth  *no '
has 'at the start, t = 0: abs\(\.\.\.\), whose argument reaches 0, in effect "V" is not'
exits 0 compare $work/kink.nevh --integrators verlet --format csv
has '^# H is not smooth on the orbit .*abs\(\.\.\.\), whose argument .* effect "V"'
exits 0 compare pendulum --integrators verlet --format csv
lacks 'H is not smooth'
exits 0 gradients $work/kink.nevh --integrators verlet --format csv
has '^# H is not smooth on the orbit'
awk -F, '$2 == "auto" && !($3 < 10*($4 + $5)) { exit 1 }' $work/out ||
    fails "has errors above their estimates"

# How long the trial run is does not depend on the machine: here each look at the
# time of computing takes ten seconds.
. "$srcdir/tests/support/nevh_interrupt.sh"
if can_stop; then
    exits 0 check kepler
    mv $work/out $work/usual
    command='check kepler (on a slow machine)'
    INTERRUPT_CLOCK= LD_PRELOAD=$PWD/$work/interrupt.so \
        ASAN_OPTIONS=$ASAN_OPTIONS:verify_asan_link_order=0 \
        "$nevh" check kepler >$work/out 2>$work/err
    cmp -s $work/out $work/usual || { fails "differs"; cat $work/out; }
else
    echo "clocks were not tested: $why"
fi

# Invariants that are none, at any step; those that are pass, also at 0.
cat >$work/central.nevh <<'END'
[coordinates]
x = 1
y = 0
p_y = 0.7
[effects]
K = (p_x^2 + p_y^2)/2
V = -1/sqrt(x^2 + y^2)
[invariants]
L = x*p_y - y*p_x
wrong = x*p_y + y*p_x
[run]
t_end = 10
dt = 0.05
integrators = verlet
END
exits 0 check $work/central.nevh --format csv
has '^# wrong of \[invariants\] is not conserved: it changes by '
lacks ' L of|# L '
exits 0 check $work/central.nevh --start p_y=0.5,y=0.001,x=0.5,p_x=0.001 --format csv
lacks '# L of'
exits 0 check kepler --format csv
lacks 'not conserved'
# Parts are told of forces that are finite: B is empty in Kepler's problem, and not at
# the edge of the domain of a root.
has '^# +B is 0: steps of any length are exact'
printf '[coordinates]\nx = 1\n[effects]\nK = p_x^2/2\nV = x^2/2\n[friction]\nf = all: 0.1\n%s\n' \
    '[run]
t_end = 9
dt = 0.1' >$work/slows.nevh
exits 0 check $work/slows.nevh --format csv
has '^# +B is 0, but there is friction: order 2'
for jump in '0.3*floor(x)' 'mod(x, 1)' '0.3*floor(x^2)' 'floor(abs(x))'; do
    printf '[coordinates]\nx = 0.3\np_x = 1\n[effects]\nK = p_x^2/2\nV = %s\n[run]\nt_end = 9\n' \
        "$jump" >$work/jump.nevh
    exits 0 check $work/jump.nevh --integrators saba2 --dt 0.1 --format csv
    lacks 'steps of any length are exact|flow is exact: K, V'
done
printf '[coordinates]\nx = 1\n[effects]\nK = p_x^2/2\nV = sqrt(1 - x^2)\n%s\n' \
    '[run]
t_end = 1
dt = 0.1
integrators = verlet' >$work/edge.nevh
exits 0 check $work/edge.nevh --format csv
lacks 'B is 0'
# Steps pass the end of this solution, x = 1/(t - 1)^2, after which y would be faster.
for t_end in 3 100; do
    printf '[coordinates]\nx = 1\ny = 1\n[effects]\nK = %s\n[run]\nt_end = %s\ndt = 0.01\n' \
        '-2*(t - 1)*p_x*x^2 + (p_y^2 + y^2*(1 + 40*max(0, t - 2)))/2' $t_end \
        >$work/pole.nevh
    exits 0 check $work/pole.nevh --format csv
    has '^# Highest frequency: omega = 1 \(t = 0\.'
    has '^# The orbit was integrated up to t = 0\.99.*: the solution itself ends at t = 1,'
done
exit $status

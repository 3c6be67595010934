#!/bin/sh
# paper.sh [NEVH [EXAMPLES [FOLDER]]]: what J. M. L. Amoreira and L. J. M. Amoreira,
# Numerical Evolution from the Hamiltonian, say, beside what nevh measures: a table,
# and where FOLDER is given and gnuplot is there, pictures of its figures.

nevh=${1:-nevh} examples=${2:-.} folder=$3
work=${TMPDIR:-/tmp}/paper.$$
trap 'rm -f $work.*' EXIT
trap 'exit 1' HUP INT TERM

# row WHERE PAPER HERE WHY: cells in lines of their widths.
row() {
    awk -v a="$1" -v b="$2" -v c="$3" -v d="$4" '
        function lines(text, width, to,    n, i, word, count) {
            n = split(text, word, " "); count = 1; to[1] = ""
            for (i = 1; i <= n; i++) {
                if (to[count] != "" && length(to[count]) + length(word[i]) >= width)
                    to[++count] = ""
                to[count] = to[count] (to[count] == "" ? "" : " ") word[i]
            }
            return count
        }
        BEGIN {
            most = lines(a, 14, A)
            if ((n = lines(b, 19, B)) > most) most = n
            if ((n = lines(c, 19, C)) > most) most = n
            if ((n = lines(d, 23, D)) > most) most = n
            for (i = 1; i <= most; i++) {
                line = sprintf("%-14s %-19s %-19s %s", A[i], B[i], C[i], D[i])
                sub(/ +$/, "", line); print line
            }
            print ""
        }'
}
# cells SCENE OPTIONS... of compare, without notes.
compare() {
    "$nevh" compare "$@" --format csv --quiet | tail -n +2
}
field() { # NUMBER, of the first line
    head -n 1 | cut -d, -f"$1"
}

row "in the paper" "what it says" "here" "why they differ"

# Listing 1 and figure 2.
"$nevh" run oscillator-paper --integrators dopri5 --tolerance 1e-3 --dt 1 --samples 301 \
    --gradient-step 0.05 --quiet >$work.orbit || exit 1
far=$(awk -F, 'NR > 1 { d = $2 - $4; d = d < 0 ? -d : d; if (d > m) m = d }
    END { printf "%.1e", m }' $work.orbit)
row "figure 2" "the oscillator's x is that of the exact solution, as far as one sees" \
    "|x - cos 2 pi t| is below $far, t = 0 ... 3" \
    "the tolerance 1e-3 of the solver, for both of them"
for d in 0.001 10; do
    "$nevh" run oscillator-paper --integrators dopri5 --tolerance 1e-3 --dt 1 \
        --samples 301 --gradient-step $d --quiet | paste -d, $work.orbit - |
        awk -F, 'NR > 1 { d = $2 - $7; d = d < 0 ? -d : d; if (d > m) m = d }
            END { printf "%.0e\n", m }'
done >$work.steps
row "listing 1" "the spread is arbitrary, for H is quadratic" \
    "delta = 0.001, 0.05 and 10: x within $(sort -g $work.steps | tail -n 1)" "rounding"

# Figure 4.
$examples/paper/divergence >$work.divergence || exit 1
at() { # WHICH of the two, T
    awk -v which="$1" -v t="$2" '/^H / { n++ } n == which && $1 == t && NF == 5 {
        d = $4 < 0 ? -$4 : $4; e = $5 < 0 ? -$5 : $5
        printf "%.0e", (d > e ? d : e) }' $work.divergence
}
row "figure 4" "spread 0.02, t = 0 ... 20: at first the same, then other angles" \
    "H as printed: angles differ by $(at 2 18) rad at t = 18. Correct H: by $(at 1 20) rad at t = 20" \
    "the printed H is more chaotic than that of two masses; steps of gauss8, no solver error"
slopes() {
    awk -v which="$1" '/^H / { n++ } n == which && /^slope/ { printf "%s", $NF }' \
        $work.divergence
}
inverse() { # of a slope
    awk -v s="$1" 'BEGIN { printf "%.3f", -1/s }'
}
exponent_of() {
    awk -v which="$1" '/^H / { n++ } n == which && /^-1.lambda/ && !seen++ {
        sub(/.*lambda = /, ""); sub(/ within /, " +- "); print }' $work.divergence
}
row "below figure 4" "smaller spreads delay it" \
    "by r/lambda when delta falls by e: lambda = $(inverse "$(slopes 1)") from delays" \
    "$(exponent_of 1) from displacements; as printed: $(inverse "$(slopes 2)") and $(exponent_of 2)"

# Figure 5.
"$examples/gradient_error" >$work.errors || exit 1
set -- $(awk '/slope/ { print $2, $3, $4, $5; exit }' $work.errors)
row "figure 5" "x^n, n = 3, 4, 5: error O(delta^2)" "slopes $2, $3, $4" "-"
row "figure 5" "n = 2: exact" "$1; below $(awk '$1 ~ /e-/ && NF == 7 && $2 + 0 > m {
    m = $2 + 0 } $1 ~ /e-04/ { exit } END { printf "%.0e", m }' $work.errors) for delta from 1e-4 on" "-"
row "figure 5" "rounding from about 5e-6 on" \
    "least error at delta = $(awk '$1 ~ /e-/ && NF == 7 && (!n++ || $4 + 0 < m) {
        m = $4 + 0; at = $1 } END { print at }' $work.errors), n = 4" "-"

# The cost.
"$examples/nevh_cost" >$work.cost || exit 1
row "cost" "about 4 times slower, in Python" \
    "$(awk '/one by one/ { print $(NF - 1) }' $work.cost) times, one by one; $(awk '/order 2, blocks/ {
        print $(NF - 1) }' $work.cost) times, as blocks" \
    "in C; as blocks the points of a difference are evaluated side by side"
set -- $(compare fput-1000 --integrators verlet --gradient central2 --t-end 10 |
    cut -d, -f14,15 | tr , ' ')
row "abstract" "unsuitable with more than a few degrees of freedom: 4 n values of H a gradient" \
    "n = 1000: $(awk -v h="$1" -v g="$2" 'BEGIN { printf "%.1f", h/g }') values of H a gradient" \
    "a term is differenced by what it reads"

# The notebooks' systems: differences of order 2 beside exact gradients.
for s in coupled-oscillators elastic-pendulum earth-halley sun-earth-moon; do
    why=
    case $s in
    earth-halley) name="Earth, Halley" why="; delta = 0.002 AU is long at perihelion, 0.6 AU"
        set -- --integrators gauss8+transform --dt 0.2 ;;
    sun-earth-moon) name="Sun, Earth, Moon"
        set -- --integrators gauss8 --dt 0.002 ;;
    elastic-pendulum) name="elastic pendulum"
        set -- --integrators gauss8 --dt 0.02 ;;
    *) name="coupled oscillators"
        set -- --integrators gauss8 --dt 0.1 ;;
    esac
    compare $s "$@" --gradient central2 >$work.two
    compare $s "$@" --gradient exact >$work.exact
    row "$name" "a notebook" "energy within $(field 9 <$work.two | xargs printf %.0e), state $(field 13 <$work.two | xargs printf %.0e)" \
        "exact gradients: $(field 9 <$work.exact | xargs printf %.0e), $(field 13 <$work.exact | xargs printf %.0e)$why"
done

# Pictures.
test -n "$folder" && command -v gnuplot >/dev/null || exit 0
"$nevh" run oscillator-paper --integrators dopri5 --tolerance 1e-3 --dt 1 \
    --samples 31 --plot-kind time --columns x,p_x --plot "$folder/figure-2.png" || exit 1
awk '/^H / { n++ } NF == 5 && $1 ~ /^[0-9]+$/ { print n, $1, $4, $5 }' \
    $work.divergence >$work.four
awk '$1 ~ /e-/ && NF == 7 { print $1, $2, $3, $4, $5; n++ } n == 17 { exit }' \
    $work.errors >$work.five
gnuplot <<END
set terminal pngcairo size 900,600
set output "$folder/figure-4.png"
set title "Angles by differences (spread 0.02) less those by hand; t = 0 ... 20 s"
set xlabel "t (s)"; set ylabel "difference (rad)"; set logscale y
set format y "%.0e"; set key left top
plot "< awk '\$1 == 1' $work.four" u 2:(abs(\$3)) w lp t "phi1, H from the Lagrangian", \
     "" u 2:(abs(\$4)) w lp t "phi2", \
     "< awk '\$1 == 2' $work.four" u 2:(abs(\$3)) w lp t "phi1, H as printed", \
     "" u 2:(abs(\$4)) w lp t "phi2, H as printed"
set output "$folder/figure-5.png"
set title "One step of 0.001, H = x^n + p^2/2: error made by differences"
set xlabel "delta"; set ylabel "L2 norm"; set logscale xy; set format x "%.0e"
plot "$work.five" u 1:2 w lp t "n = 2", "" u 1:3 w lp t "n = 3", \
     "" u 1:4 w lp t "n = 4", "" u 1:5 w lp t "n = 5", x**2 lt 0 t "slope 2"
END

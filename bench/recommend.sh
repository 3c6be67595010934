#!/bin/sh
# Whether nevh recommend finds the cheapest.  For each pair of a scene and a
# target, every integrator that fits, adaptive ones too, every gradient and
# every step (or tolerance) of the same grid is run that could win: those whose
# runs take no more than 1.5 times as long as what is recommended; a shorter
# step takes longer than a longer one.  Schemes that keep the energy at any
# step take part where the target is one of states.  The recommended and the
# cheapest few found are then timed again, one after the other in turn, as
# medians of nine.  Prints a row a pair; fails where a ratio is above 1.15.
# Usage: recommend.sh NEVH [PAIR...], PAIR being SCENE,energy|state,TARGET,T_END;
# DENSITY in the environment: steps a decade, 80 if not given

nevh=${1:?}
shift
test $# -gt 0 || set -- pendulum,energy,1e-6,50 pendulum,energy,1e-10,50 \
    kepler,state,1e-6,20 kepler,energy,1e-8,20 \
    henon-heiles,energy,1e-4,50 henon-heiles,energy,1e-10,50 \
    oscillator,state,1e-6,50 double-pendulum,energy,1e-6,2 \
    double-pendulum,energy,1e-9,2 figure-eight,energy,1e-6,6.4
work=${TMPDIR:-/tmp}/recommend.$$
trap 'rm -f $work $work.*' EXIT
status=0
DENSITY=${DENSITY:-80}

grid() { # FROM TO: steps, at least eight a run
    awk -v from="$1" -v to="$2" -v end="$3" -v density=$DENSITY 'BEGIN {
        for (i = -3 * density; i <= 7 * density; i++) {
            x = 10 ^ (-i / density)
            if (x <= from * 1.001 && x >= to * 0.999 && 8 * x <= end * 1.001)
                printf "%s%.6g", n++ ? "," : "", x } }'
}
tolerances() { # TO
    awk -v to="$1" 'BEGIN {
        for (i = 20; i <= 260; i++) {
            x = 10 ^ (-i / 20)
            if (x >= to * 0.999) printf "%s%.6g", n++ ? "," : "", x } }'
}
rows() { # SCENE T_END, and options
    scene=$1 end=$2
    shift 2
    "$nevh" compare "$scene" --t-end "$end" --quiet --format csv "$@" |
        awk -F, '!/^#/ && $1 != "scene"'
}
# That keep the energy at any step, quadratic H or not, have nothing to tell of
# it.
schemes() { # SCENE T_END energy|state
    "$nevh" check "$1" --t-end "$2" --format csv | awk -F, -v by="$3" '
        !/^#/ && $3 == "yes" && !(by == "energy" && $1 ~ /^(gonzalez|itoh|avf)/) &&
        $1 !~ /naive/ { print $1 }'
}
adapts() {
    case $1 in dop* | gsl-rk* | gsl-ms*) return 0 ;; esac
    return 1
}
# What runs of $name give: seconds, and the options that make the row again.
candidates() { # BY TARGET TOLERANCES
    awk -F, -v by="$1" -v target="$2" -v tolerances="$3" -v landing="$landing" '
        BEGIN { count = split(tolerances, tolerance, ",") }
        { e = by == "state" ? $13 : $9
          step = count ? landing " --tolerance " tolerance[(NR - 1) % count + 1] : $6
          if ($8 == "ok" && e != "" && e + 0 <= target + 0)
              print $17, "--integrators", $2, "--gradient", $5, "--dt", step }'
}
# What a run takes at a coarse step, or at a finer one where the scheme is not
# stable, tells the shortest step that may win: runs take 1.5 times as long as
# what is recommended, or less.
shortest() { # SCENE T_END SECONDS
    for part in 200 800 3200 12800; do
        fine=$(rows "$1" "$2" --integrators $name --gradient exact --repeat 3 \
            --dt $(awk "BEGIN { print $2 / $part }") |
            awk -F, -v most="$3" '$8 == "ok" {
                print 0.6 * $6 * $17 / (1.5 * most) }')
        test -z "$fine" || break
    done
    echo "${fine:-1e9}"
}
# As rows, but for no longer than many times what they should take together.
limited() { # SECONDS SCENE T_END, and options
    most=$(awk "BEGIN { print int(20 + 5000 * $1) }")
    shift
    (ulimit -t "$most" && rows "$@") >$work.rows
    tail -n 1 $work.rows | grep -q , ||
        echo "$name: no rows within $most s" >&2
    cat $work.rows
}
brute_force() { # SCENE BY TARGET T_END SECONDS: candidates, best first
    gradients=exact,central2,central4,central6,central8,complex-step
    for name in $(schemes "$1" "$4" "$2"); do
        if adapts $name; then
            limited "$5" "$1" "$4" --integrators $name \
                --gradient $gradients --dt $landing \
                --tolerance "$(tolerances 1e-13)" --repeat 1 |
                candidates $2 $3 "$(tolerances 1e-13)"
            continue
        fi
        steps=$(grid $(awk "BEGIN { print $4 / 8 }") \
            "$(shortest "$1" "$4" "$5")" "$4")
        test -z "$steps" || limited "$5" "$1" "$4" --integrators $name \
            --gradient $gradients --dt "$steps" --repeat 1 |
            candidates $2 $3 ""
    done | sort -g
}
# Medians of rows timed in turn: each line of the file holds the options of
# one; prints its seconds before it.
in_turn() { # SCENE T_END FILE
    for round in 1 2 3 4 5 6 7 8 9; do
        while read -r line; do
            echo "$(rows "$1" "$2" $line --repeat 3 | awk -F, '{ print $17 }') $line"
        done <"$3"
    done | sort -g | awk '{ s = $1; sub(/^[^ ]* /, ""); n[$0]++
        if (n[$0] == 5) print s, $0 }'
}

printf '%-16s %-6s %-6s %9s %s\n' scene by target ms \
    'recommended; below it the cheapest found'
for pair; do
    scene=${pair%%,*} rest=${pair#*,}
    by=${rest%%,*} rest=${rest#*,}
    target=${rest%%,*} end=${rest#*,}
    "$nevh" recommend "$scene" --$by-error "$target" --t-end "$end" >$work
    mine=$(sed -n 's/^  nevh compare [^ ]* *//p' $work | sed 's/ --t-end.*//')
    landing=$("$nevh" compare "$scene" --t-end "$end" --integrators rk4 --quiet \
        --format csv | awk -F, '$2 == "rk4" { dt = $6 > dt ? $6 : dt }
            END { print 8 * dt }')
    case $mine in *--tolerance*)
        landing=$(echo "$mine" | sed 's/.*--dt \([^ ]*\).*/\1/') ;;
    esac
    takes=$(rows "$scene" "$end" $mine --repeat 9 | awk -F, '{ print $17 }')
    brute_force "$scene" $by "$target" "$end" "$takes" >$work.found
    { echo "$mine" && head -n 5 $work.found | cut -d' ' -f2- |
        grep -Fvx -e "$mine"; } >$work.best
    in_turn "$scene" "$end" $work.best >$work.timed
    awk -v mine="$mine" -v pair="$pair" -v runs=$(wc -l <$work.found) '
        NR == 1 { best = $0; least = $1 }
        { s = $1; line = $0; sub(/^[^ ]* /, "", line)
          if (line == mine) own = s }
        END { split(pair, p, ",")
            gsub(/--(integrators|gradient|dt) /, "", best)
            gsub(/--(integrators|gradient|dt) /, "", mine)
            sub(/^[^ ]* /, "", best)
            printf "%-16s %-6s %-6s %9.3g %s\n", p[1], p[2], p[3], 1e3 * own, mine
            printf "%-30s %9.3g %s; ratio %.2f, of %d that keep it\n", "", 1e3 * least,
                best, own / least, runs
            exit !(own <= 1.15 * least) }' $work.timed || status=1
done
exit $status

#!/bin/sh
# Whether nevh recommend finds the cheapest: for ten pairs of a scene and a
# target, every integrator, gradient and step of its grid is run, too.  Prints
# the seconds of both, timed again one after the other, and their ratio; fails
# where that is above 1.3.  Takes a minute or so a pair.
# Usage: recommend.sh NEVH [PAIR...], PAIR being SCENE,energy|state,TARGET,T_END

nevh=${1:?}
shift
test $# -gt 0 || set -- pendulum,energy,1e-3,20 pendulum,energy,1e-6,20 \
    pendulum,energy,1e-10,20 kepler,energy,1e-6,20 kepler,state,1e-8,20 \
    henon-heiles,energy,1e-4,50 henon-heiles,energy,1e-9,50 \
    double-pendulum,energy,1e-6,2 elastic-pendulum,energy,1e-8,5 \
    kapitza,state,1e-6,2
work=${TMPDIR:-/tmp}/recommend.$$
trap 'rm -f $work' EXIT
status=0

field() { # NAME of the last row of $work
    awk -F, -v name="$1" '/^#/ { next }
        !n++ { for (i = 1; i <= NF; i++) if ($i == name) column = i; next }
        { value = $column } END { print value }' $work
}
# The grid, ten steps a decade, around what was recommended; a run has at least
# eight steps.
grid() {
    awk -v dt="$1" -v end="$2" 'BEGIN { split("1 1.25 1.6 2 2.5 3.2 4 5 6.4 8", digit, " ")
        for (d = 2; d >= -6; d--) for (i = 10; i > 0; i--) {
            x = digit[i] * 10 ^ d
            if (x < 5 * dt && x > dt / 100 && 8 * x <= end)
                printf "%s%.6g", n++ ? "," : "", x } }'
}
schemes() { # those that fit, have steps of their own, and do not keep the
            # energy at any step
    "$nevh" check "$1" --t-end "$2" --format csv | awk -F, '$3 == "yes" &&
        $1 !~ /^(itoh|gonzalez|avf|dop|gsl|adaptive|naive)/ {
            printf "%s%s", n++ ? "," : "", $1 }'
}
seconds() { # SCENE T_END INTEGRATOR GRADIENT DT
    "$nevh" compare "$1" --t-end "$2" --integrators "$3" --gradient "$4" \
        --dt "$5" --repeat 15 --format csv >$work
    field seconds
}

printf '%-18s %-6s %-6s  %-34s %-34s %s\n' scene by target recommended \
    "brute force" ratio
for pair; do
    scene=${pair%%,*} rest=${pair#*,}
    by=${rest%%,*} rest=${rest#*,}
    target=${rest%%,*} end=${rest#*,}
    all=$(schemes "$scene" "$end")
    "$nevh" recommend "$scene" --$by-error "$target" --t-end "$end" \
        --integrators "$all" --format csv | sed '/^#/!{n;q}' >$work
    mine="$(field integrator) $(field gradient) $(field dt)"
    "$nevh" compare "$scene" --t-end "$end" --integrators "$all" --repeat 1 \
        --gradient exact,central2,central4,central6,central8 --dt "$(grid "$(field dt)" "$end")" \
        --format csv >$work
    other=$(awk -F, -v by=$by -v target="$target" '/^#/ || $8 != "ok" { next }
        { e = by == "state" ? $13 : $9 }
        e != "" && e + 0 <= target + 0 && (least == "" || $17 < least) {
            least = $17; best = $2 " " $5 " " $6 } END { print best }' $work)
    mine_takes=$(seconds "$scene" "$end" $mine)
    other_takes=$(seconds "$scene" "$end" $other)
    ratio=$(awk "BEGIN { printf \"%.2f\", $mine_takes / $other_takes }")
    awk "BEGIN { exit $ratio > 1.3 }" || status=1
    printf '%-18s %-6s %-6s  %-34s %-34s %s\n' "$scene" $by "$target" "$mine" \
        "$other" "$ratio"
done
exit $status

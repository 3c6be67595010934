#!/bin/sh
# figures.sh SRCDIR NEVH EXAMPLES: makes anew what the manual
# and the README show, in SRCDIR/doc.  Milliseconds
# are those of the machine, and of what else it does meanwhile.

srcdir=$1 nevh=$2 examples=$3
NEVH_SCENES=$srcdir/scenes
export NEVH_SCENES

# A command, in lines of a page's width.
shown_lines() {
    awk '{ while (length($0) > 84) {
               for (i = 79; substr($0, i, 3) != " --" && i > 8; ) i--
               print substr($0, 1, i) "\\"
               $0 = "      " substr($0, i + 1)
           }
           print }'
}

# quote NAME COMMAND...: what it prints, below the command.
quote() {
    file=$srcdir/doc/$1.txt
    shown="nevh $(shift 2 && echo "$*")"
    test "$2" = "$nevh" || shown=$(basename "$2")
    shift
    echo "$shown" >&2
    { echo "\$ $shown" | shown_lines && "$@"; } >"$file.new" 2>&1 && mv "$file.new" "$file"
}

quote compare-first "$nevh" compare pendulum --dt 0.05 \
    --integrators verlet,gauss4,rk4
quote compare-pendulum "$nevh" compare pendulum
"$nevh" compare pendulum --dt 0.05 --integrators verlet,gauss4,rk4 --t-end 3000 \
    --plot "$srcdir/doc/energy.svg" >/dev/null
quote cost-pendulum "$nevh" cost pendulum --t-end 100 \
    --integrators verlet,blanes-moan4,gauss4,gauss8,rk4
quote cost-length-pendulum "$nevh" cost pendulum --against length --t-end 500
quote recommend-pendulum "$nevh" recommend pendulum --energy-error 1e-8 --t-end 100
quote gradients-pendulum "$nevh" gradients pendulum --t-end 100

for native in never always; do
    quote native-$native "$nevh" compare henon-heiles --t-end 1000 --dt 0.05 \
        --integrators verlet,blanes-moan6,rkn11b,gauss8,rk4 --gradient exact \
        --native $native
done

# Of hard cases the counts, a line a case.
echo "nevh hard" >&2
"$nevh" hard --integrators verlet,gauss4,rk4 --all --format csv -o "$srcdir/doc/hard.csv" 2>/dev/null
awk -f "$srcdir/doc/hard.awk" "$srcdir/doc/hard.csv" >"$srcdir/doc/hard.txt"
rm -f "$srcdir/doc/hard.csv"

# Of verdicts on scenes that do not ship, all groups together.  Long runs are made
# once, in an hour.
echo "bench/verdicts" >&2
bench/verdicts -w 0.15 -o bench/wrong-verdicts -r bench/long-runs "$srcdir" \
    "$srcdir/bench/textbook/list" "$srcdir/bench/blind/list" 2>/dev/null | sed -n '/^all:/,$p' >"$srcdir/doc/verdicts.txt"

echo "paper.sh" >&2
sh "$srcdir/examples/paper/paper.sh" "$nevh" "$examples" >"$srcdir/doc/paper.new" &&
    mv "$srcdir/doc/paper.new" "$srcdir/doc/paper.txt"
quote gradient-cost "$examples/gradient_cost"
quote steps-that-follow "$examples/steps_that_follow"
quote nevh-cost "$examples/nevh_cost"

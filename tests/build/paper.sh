#!/bin/sh
# What the manual says of the paper: the table, and the commands of its chapter.

. "${srcdir:-.}/tests/support/nevh_support.sh"

# The example is run once, for the table, too.
command=divergence
./examples/paper/divergence >$work/divergence || fails "exit status $?"
mkdir -p $work/examples/paper
ln -s "$PWD/examples/gradient_error" "$PWD/examples/nevh_cost" $work/examples
printf '#!/bin/sh\ncat "%s"\n' "$PWD/$work/divergence" >$work/examples/paper/divergence
chmod +x $work/examples/paper/divergence

command="paper.sh"
sh "$srcdir/examples/paper/paper.sh" "$nevh" $work/examples >$work/table ||
    fails "exit status $?"
tr -s ' \n' ' ' <$work/table >$work/out
has 'slopes 2\.00, 2\.00,'
has 'values of H a'
awk 'length > 79 { print; wide = 1 } END { exit wide }' $work/table ||
    fails "is wider than 79 columns"

# Its numbers but for the times are those that the manual quotes.
numbers() { sed '/^cost /,/^$/d' "$1" | tr -s ' \n' ' '; }
numbers $work/table >$work/now
numbers "$srcdir/doc/paper.txt" >$work/then
test "$(wc -w <$work/now)" = "$(wc -w <$work/then)" ||
    { fails "is not the table of the manual"; diff "$srcdir/doc/paper.txt" $work/table; }

# Delays and displacements give the same exponent, within its error; another
# order in the fit would not.
command=divergence
awk '/^slope/ { slope = $NF; n = 0 }
    /^-1.lambda/ && !n++ { sub(",", "", $0); value = $(NF - 2); error = $NF
        d = -1/slope - value; if (d*d > 4*error*error) wrong = 1
        d = -2/slope - value; if (d*d < error*error) wrong = 1
        rows++ }
    END { exit wrong || rows != 2 }' $work/divergence ||
    { fails "slopes are not 1/lambda"; cat $work/divergence; }

exits 0 compare fput-1000 --integrators verlet --gradient central2 --t-end 10 \
    --format csv --quiet
awk -F, 'NR > 1 && $14/$15 < 5 { found = 1 } END { exit !found }' $work/out ||
    fails "takes many values of H"
exits 0 run oscillator-paper --integrators dopri5 --tolerance 1e-3 --dt 1 --samples 31
grep -v '^#' $work/out | awk -F, 'NR > 1 { d = $2 - $4; if (d*d > 2e-5) exit 1; n++ }
    END { if (n != 31) exit 1 }' || fails "is not the exact solution"
exit $status

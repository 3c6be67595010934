#!/bin/sh
# fit.sh NEVH ADD_NOISE [DRAWS]: how often the 95 % intervals of
# nevh fit hold the truth.  Each draw is another noise over the same orbit of
# pendulum-filmed.  Prints a row a number; fails where a share is not
# 95 % within 3 of 400 draws, or within three standard deviations of fewer.

nevh=$1 add_noise=$2 draws=${3:-400}
work=${TMPDIR:-/tmp}/fit.$$
trap 'rm -f $work.*' EXIT
trap 'exit 1' HUP INT TERM
: >$work.rows
"$nevh" run pendulum-filmed --set l=0.874,g=9.812,gamma=0.035,start=1.13 \
    --integrators gauss8 --dt 1/30 --samples 121 --quiet >$work.orbit || exit 1
i=0
while test $i -lt "$draws"; do
    i=$((i + 1))
    "$add_noise" 0.004 $i x y <$work.orbit >$work.data
    "$nevh" fit pendulum-filmed --data $work.data --vary l,g --format csv --quiet \
        --set l=0.9,g=9.5,gamma=0.035,start=1.13 >$work.out || exit 1
    tail -n +2 $work.out >>$work.rows
done
awk -F, -v draws="$draws" '
    BEGIN { truth["l"] = 0.874; truth["g"] = 9.812 }
    { x = $4; n[x]++; d = $6 - truth[x]; z = d/$7
      inside[x] += $8 <= truth[x] && truth[x] <= $9
      one[x] += z > -1 && z < 1; sum[x] += z; squares[x] += z*z }
    END {
        print " number  draws  in the 95 % interval  within one error  mean z  rms z"
        most = draws == 400 ? 0.03 : 3*sqrt(0.95*0.05/draws)
        for (x in truth) {
            share = inside[x]/n[x]
            printf " %-6s %6d %17.1f %% %15.1f %% %7.3f %6.3f\n", x, n[x],
                100*share, 100*one[x]/n[x], sum[x]/n[x], sqrt(squares[x]/n[x])
            if (n[x] != draws || share < 0.95 - most || share > 0.95 + most + 1e-9)
                wrong = 1
        }
        exit wrong }' $work.rows

#!/bin/sh
# Whether nevh check warns of runs that go wrong, and of no others.
#
#     bench/warnings.sh NEVH ROOT [HALF]
#
# Pairs of a scene and a step, each with four schemes.  `saddle`: starts beside a
# separatrix.  A run is wrong where it turns, passes the saddle or does not, unlike the
# orbit by Taylor series.  `passage`: the scenes of bench/textbook and bench/blind over
# five of their periods.  A run is wrong where its energy error is above a tenth of the
# scale, or it breaks off; and a warning is right also where the state has no digit, or
# the run is unstable.  `drive`: the same with steps that are parts of the period of a
# drive, and longer ones.  Thresholds were chosen by the scenes of bench/textbook and by the
# odd ones of the starts; HALF (tuned, other; both where it is left out) takes one of them.
# Prints cases that differ; the exit status is 1 where warnings of a kind are wrong, or
# wrong runs are among those without a warning, in more than 5 %.  rk4, whose errors add
# up, is counted on its own.
# SPDX-License-Identifier: GPL-3.0-or-later

nevh=$1
root=$2
half=${3:-both}
schemes=verlet,midpoint,gauss4,rk4
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
trap 'exit 1' HUP INT TERM

number() { awk "BEGIN { printf \"%.6g\", $1 }"; }

# warned TEXT: of which schemes the output of check warns with such a text.
warned() {
    grep '^# Warning: ' "$work/check" | grep -e "$1" | tr -d , | tr ' :' '\n\n' |
        grep -xE 'verlet|midpoint|gauss4|rk4'
}

# turns SADDLE PERIOD: whether an orbit turns, stays at one side between two turns,
# changes sides between two turns, and goes away.
turns() {
    awk -F, -v saddle="$1" -v period="$2" '/^#/ { next } !titles++ { next }
        {
            q = $2
            if (rows++ > 1 && (q - last)*way < 0) {
                side = period > 0 ? int((last - saddle)/period + 1000) : last > saddle
                if (turned++) { if (side == before) same = 1; else other = 1 }
                before = side
            }
            if (rows > 1 && q != last) way = q - last
            last = q
            if (period == 0 && (q > 1000 || q < -1000)) away = 1
        }
        END { print (turned > 0) same + 0 other + 0 away + 0 }'
}

# orbit SCENE START T_END DT SCHEME
orbit() {
    timeout 60 "$nevh" run "$root/$1.nevh" --start "$2" --t-end $3 --dt $4 \
        --integrators $5 --every 1 --quiet 2>/dev/null
}

# saddle SCENE SADDLE PERIOD T_END STEPS STARTS
saddle() {
    count=0
    for start in $(echo "$6" | tr ';' ' '); do
        count=$((count + 1))
        part=$(test $((count % 2)) -eq 1 && echo tuned || echo other)
        test $half = both || test $half = $part || continue
        for dt in $5; do
            own=$(orbit $1 $start $4 $dt taylor | turns $2 $3)
            timeout 60 "$nevh" check "$root/$1.nevh" --start $start --t-end $4 \
                --dt $dt --integrators $schemes --format csv >"$work/check" 2>/dev/null
            warned saddle >"$work/warned"
            for scheme in $(echo $schemes | tr , ' '); do
                run=$(orbit $1 $start $4 $dt $scheme | turns $2 $3)
                wrong=$(test $run = $own && echo 0 || echo 1)
                says=$(grep -cx $scheme "$work/warned")
                echo "saddle $part $scheme $says $wrong $wrong $1 $start dt = $dt"
            done
        done
    done
}

# passage PART SCENE FREQUENCY PERIOD [KIND]
passage() {
    kind=${5:-passage}
    test $half = both || test $half = $1 || return
    t_end=$(number "5*$4")
    for x in $(test $kind = drive && echo 0.3 1 2 3 4.5 6.2832 ||
        echo 0.15 0.3 0.5 0.8 1.2 1.8 2.5); do
        dt=$(number "$x/$3")
        timeout 60 "$nevh" check "$root/$2.nevh" --t-end $t_end --dt $dt \
            --integrators $schemes --format csv >"$work/check" 2>/dev/null
        timeout 60 "$nevh" compare "$root/$2.nevh" --t-end $t_end --dt $dt --repeat 1 \
            --integrators $schemes --format csv 2>/dev/null >"$work/compare"
        warned 'too long for' >"$work/warned"
        grep -v '^#' "$work/compare" | sed 's/"[^"]*"/"/g' |
            awk -F, -v warned="$work/warned" -v part=$1 \
                -v kind=$kind -v scene=$2 -v dt=$dt '
                BEGIN { while ((getline scheme < warned) > 0) says[scheme] = 1 }
                FNR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next }
                $at["steps"] == "" { next }
                {
                    scheme = $at["integrator"]; status = $at["status"]
                    error = $at["max_energy_error"]; verdict = $at["verdict"]
                    breaks = status != "ok" && status !~ /^unstable/
                    wrong = breaks || error == "" || error > 0.1
                    other = wrong || verdict == "unstable" || $at["state_error"] > 0.5
                    print kind, part, scheme, says[scheme] + 0, wrong, other,
                        scene, "dt =", dt, "error", error, $at["state_error"]
                }'
    done
}

{
    saddle scenes/pendulum 3.14159265 6.2831853 60 '0.25 0.125 0.06 0.03 0.01' \
        'phi=0,p_phi=6.0;phi=0,p_phi=6.2;phi=0,p_phi=6.25;phi=0,p_phi=6.26;phi=0,p_phi=6.2609;phi=0,p_phi=6.2612;phi=0,p_phi=6.262;phi=0,p_phi=6.27;phi=0,p_phi=6.3;phi=0,p_phi=6.5;phi=1.5,p_phi=4.5;phi=-2,p_phi=3.4'
    saddle bench/textbook/double-well-edge 0 0 100 '0.8 0.4 0.2 0.1 0.05' \
        'x=1,p_x=0.6;x=1,p_x=0.69;x=1,p_x=0.7;x=1,p_x=0.706;x=1,p_x=0.707;x=1,p_x=0.7073;x=1,p_x=0.71;x=1,p_x=0.72;x=1.41401,p_x=0;x=1.4,p_x=0;x=1.415,p_x=0;x=1.45,p_x=0'
    saddle bench/textbook/cubic-well 1 0 60 '0.8 0.4 0.2 0.1 0.05' \
        'x=0,p_x=0.5;x=0,p_x=0.55;x=0,p_x=0.57;x=0,p_x=0.576;x=0,p_x=0.577;x=-0.4993,p_x=0;x=-0.49,p_x=0;x=-0.45,p_x=0'
    for folder in textbook blind; do
        part=$(test $folder = textbook && echo tuned || echo other)
        grep '^bench/' "$root/bench/$folder/list" | while read -r scene omega period _; do
            passage $part $scene $omega $period
        done
    done
    while read -r scene omega period; do
        passage other $scene $omega $period drive
    done <<EOF
scenes/kapitza 100 4
scenes/damped-driven-pendulum 0.667 9.4
bench/textbook/driven-duffing 1.1 5.7
bench/textbook/driven-morse 0.6 10.5
bench/textbook/driven-pendulum 0.7 9
bench/textbook/mathieu-stable 2 6.3
bench/textbook/paul-trap 2 10
bench/blind/mass-filter 2 8.25
bench/blind/pendulum-kicked 1 6.28
EOF
} >"$work/all"

awk '{
    kind = $1 " " $2 ($1 != "saddle" && $3 == "rk4" ? " rk4" : "")
    if ($4) { warned[kind]++; right[kind] += $6 } else { silent[kind]++; missed[kind] += $5 }
    if ($4 && !$6) print "not wrong: " $0
    if (!$4 && $5) print "no warning: " $0
    kinds[kind]
} END {
    for (kind in kinds) {
        of = warned[kind]; no = silent[kind]
        printf "%s: %d of %d warnings right (%.1f %%); %d of %d runs without one wrong (%.1f %%)\n",
            kind, right[kind], of, of ? 100*right[kind]/of : 100, missed[kind], no,
            no ? 100*missed[kind]/no : 0
        bad = bad || right[kind] < 0.95*of || (kind !~ /rk4/ && missed[kind] > 0.05*no)
    }
    exit bad
}' "$work/all"

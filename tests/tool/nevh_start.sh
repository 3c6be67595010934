#!/bin/sh
# What options change: the start, times as formulas, effects in lists, titles.

. "${srcdir:-.}/tests/support/nevh_support.sh"

rows() { grep -v '^#' $work/out; }
# same NAME: the rows are those in $work/NAME.
same() {
    rows >$work/these
    cmp -s $work/these $work/$1 || { fails "differs from $1"; cat $work/out; }
}

# A start by option is the start that a scene says.
sed 's/^phi = .*/phi = 0.1, 0.3 ; period 2*pi/' "$srcdir/scenes/pendulum.nevh" \
    >$work/moving.nevh
exits 0 run $work/moving.nevh --t-end 2 --samples 5
rows >$work/moving
exits 0 run pendulum --start phi=0.1 --start p_phi=0.3 --t-end 2 --samples 5
same moving
exits 0 run pendulum --start 'phi=start/20, v_phi=0.3' --t-end 2 --samples 5
same moving
has '^# start: phi=start/20$'
exits 0 run pendulum --start phi=1 --start phi=0.1,p_phi=0.3 --t-end 2 --samples 5
same moving
exits 0 run pendulum --t-end 2 --samples 5
rows | cmp -s - $work/moving && fails "moves as from elsewhere"
exits 0 run fput --start 'x[i = 1..32] = 0' --start 'x[2] = 1' --t-end 1 \
    --samples 2 --quiet
has '^0,0,1,0,0,'
exits 0 run fput --start x=0,p_x=0 --t-end 1 --samples 2 --quiet
has '^1(,0)*$'

# What is no start, or no parameter.
exits 2 run pendulum --start start=1
says '--start: there is no coordinate, momentum .* start; there are phi, p_phi'
exits 2 run double-pendulum --start fhi1=1
says 'did you mean phi1'
exits 2 run pendulum --set phi=1
says 'where the motion starts is changed by --start phi=1'
exits 2 run pendulum --set p_phi=1
says 'changed by --start p_phi=1'
exits 2 run pendulum --start phi=here
says '--start: the name here is not known'
exits 0 run pendulum --set start=0.1,l=2 --t-end 1 --samples 2
has '^0,0\.1'
has '^# set: l=2$'

# Times are formulas of parameters, in options as in scenes.
exits 0 run pendulum --t-end 2 --dt 0.0625 --at 0.5,2
rows >$work/times
exits 0 run pendulum --t-end '2*m*start/start' --dt 1/16 --at 'min(start/4, 9),l*2'
same times
exits 0 compare pendulum --dt pi/50,pi/100 --t-end '10*2*pi*sqrt(l/g)' \
    --integrators verlet --format csv
rows | awk -F, 'NR == 2 { a = $6 } NR == 3 { b = $6 }
    END { exit !(a > 0.0628 && a < 0.0629 && b > a/2.001 && b < a/1.999) }' ||
    fails "takes other steps"
for wrong in '--t-end phi' '--dt 0.1,' '--dt 0x1p-3' '--at 1,wrong' '--dt -l' \
    '--t-end inf' '--samples 0x10' '--t-end 1/0'; do
    exits 2 run pendulum $wrong
    says "^nevh: ${wrong%% *}"
done
exits 2 run pendulum --t-end 5 --at 5.0000000000001
says '--at 5\.0000000000001: the run is from t = 0 to 5$'

# Effects in lists.
exits 0 compare damped-driven-pendulum --without drag,drive --t-end 5
has 'off: drive, drag'
exits 0 compare damped-driven-pendulum --without drag,drive --with drag --t-end 5
has 'off: drive \('
exits 2 compare damped-driven-pendulum --without drag,dive
says 'dive; did you mean drive'
exits 2 compare pendulum --integrators verlet,
says '--integrators: a name is missing'
exits 2 compare pendulum --integrators 'verlet rk4'
says 'separated by commas'

# Titles tell what was changed.
exits 0 compare pendulum --integrators verlet --t-end 20
has '^Pendulum released at rest from 2 rad$'
exits 0 compare pendulum --integrators verlet --t-end 20 --set start=0.1 \
    --start p_phi=1 --without gravity
has '^Pendulum released at rest from 2 rad, but start=0\.1, p_phi=1, without gravity$'
exits 0 compare sun-earth-moon --t-end 0.1 --integrators verlet --dt 0.01 \
    --set "m=1.0000000000000, 1/333000.00, 0.01230002/332946.05"
has '^Sun, Earth and Moon, but m changed$'
for do in run section compare; do
    exits 0 $do pendulum --integrators verlet --t-end 20 --start phi=0.1 \
        --plot $work/x.svg --keep-plot-script $work/script
    grep -q 'from 2 rad, but phi=0.1' $work/script ||
        fails "draws another title"
done

# The command that recommend ends in is to be typed as it stands.
exits 0 recommend pendulum --energy-error 1e-3 --t-end '2*pi*sqrt(l/g)' \
    --start phi=0.5 --integrators verlet
has "--start phi=0.5"
has "--t-end '2\*pi\*sqrt\(l/g\)'"
exit $status

#!/bin/sh
# Every kind of picture of every command as SVG, without gnuplot: XML that is well
# formed, small, with a panel and a curve at least, and with numbers alone.

. "${srcdir:-.}/tests/support/nevh_support.sh"

svg=$work/out.svg
# gnuplot is not asked.
mkdir $work/bin
printf '#!/bin/sh\ntouch %s\nexit 1\n' "$PWD/$work/asked" >$work/bin/gnuplot
chmod +x $work/bin/gnuplot
PATH=$PWD/$work/bin:$PATH
parser=
command -v xmllint >/dev/null 2>&1 && parser='xmllint --noout'
test -n "$parser" || command -v python3 >/dev/null 2>&1 &&
    parser=${parser:-python3 -c 'import sys, xml.dom.minidom as m; m.parse(sys.argv[1])'}

is_picture() {
    test -s $svg || { fails "draws nothing"; return; }
    size=$(wc -c <$svg)
    test "$size" -le 400000 || fails "draws $size bytes"
    if test -n "$parser"; then
        $parser $svg >$work/parsed 2>&1 || { fails "is no XML"; head $work/parsed; }
    fi
    grep -Eq '[^a-z](nan|inf)[^a-z]' $svg && fails "has what is no number"
    texts | grep -q . || fails "has no texts"
    grep -q "stroke='#555555'" $svg || fails "has no axis"
}
# draws PANELS ARGUMENT...: 0: any number.
draws() {
    panels=$1
    shift
    rm -f $svg
    exits 0 "$@" $svg
    is_picture
    drawn=$(grep -c "stroke='#dddddd'" $svg)
    test $panels = 0 && panels=$drawn
    test "$drawn" = $panels || fails "has $drawn panels, not $panels"
}

for scene in pendulum henon-heiles kepler; do
    for kind in phase time energy; do
        draws 0 run $scene --plot-kind $kind --t-end 50 --plot
    done
    draws 0 compare $scene --t-end 10 --plot
    draws 0 compare $scene --integrators verlet,rk4 --t-end 5 --dt 0.1,0.05,0.02 \
        --plot-kind order --plot
    draws 2 cost $scene --integrators verlet,rk4 --t-end 5 --dt 0.1,0.05 --plot
    draws 0 cost $scene --integrators verlet,rk4 --t-end 5 --dt 0.1,0.05 \
        --plot-kind order --plot
    draws 1 gradients $scene --t-end 5 --gradient central2,central4 --plot
    draws 0 effects $scene --impact --t-end 5 --plot
    draws 0 flow $scene --integrators verlet,rk4 --t-end 5 --plot
done
for scene in pendulum henon-heiles pendulum-small; do
    draws 2 portrait $scene --integrators verlet,rk4 --t-end 50 --plot
done
for scene in pendulum henon-heiles damped-driven-pendulum; do
    draws 0 section $scene --t-end 200 --plot
done
for scene in kepler double-pendulum sun-earth-moon; do
    draws 2 run $scene --plot-kind configuration --t-end 5 --plot
done
# Long runs have no more bytes than a screen shows.
draws 2 run pendulum --t-end 1000 --plot
draws 2 run double-pendulum --plot-kind configuration --t-end 400 --plot
draws 1 section henon-heiles --t-end 20000 --plot

# The legend has what the commands were given, once; curves their names.
draws 1 run pendulum --plot-kind time --columns phi --integrators verlet,rk4 --t-end 9 --plot
for name in verlet rk4; do
    test "$(texts | grep -cx $name)" = 1 || fails "has not $name in its legend"
    grep -q "<title>$name</title>" $svg || fails "has no curve $name"
done

# Maps: colours and a scale, hatched where there is no value; cells of any number,
# with steps that are not equal.
draws 1 sweep pendulum --vary 'phi = range(0, 3, 8)' --vary 'p_phi = range(0, 8, 7)' \
    --dt 0.05 --t-end 1 --outcomes 'first(phi > 3.5)' --picture
grep -q "stroke='#999999'" $svg || fails "hatches nothing"
texts | grep -qF 'first(phi &gt; 3.5) (s)' || fails "has no label at its scale"
draws 1 sweep pendulum --vary 'phi = 0, 1, 3' --vary 'p_phi = 0, 8, 9' \
    --dt 0.05 --t-end 1 --outcomes 'max(phi)' --picture
grep -q "stroke='#999999'" $svg && fails "hatches what has a value"
# Colours by rank where values crowd: each takes a share of the cells; not where they
# do not.
crowd() { # FORMULA
    draws 1 sweep pendulum --vary 'phi = range(0.01, 1, 20)' --vary 'p_phi = range(0.01, 1, 20)' \
        --dt 0.1 --t-end 0.1 --outcomes "last($1)" --integrators verlet --picture
    grep "<path stroke='#" $svg | grep -c "stroke-width='[0-9][0-9]*'" >$work/levels
}
crowd '(phi*p_phi)^6'
texts | grep -q ', by rank$' || fails "ranks no crowded values"
test "$(cat $work/levels)" -gt 60 || fails "shows $(cat $work/levels) colours of crowded values"
crowd 'phi + p_phi'
texts | grep -q 'by rank' && fails "ranks values that do not crowd"
draws 1 sweep pendulum --vary 'phi = range(-3, 3, 350)' --dt 0.2 --t-end 0.2 \
    --vary 'p_phi = range(-4, 4, 350)' --outcomes 'mean(sin(1e7*phi + 3e6*p_phi))' \
    --integrators verlet --picture
test "$(wc -c <$svg)" -gt 100000 || fails "leaves out most cells"
draws 1 sweep pendulum --vary 'phi = range(0.1, 3, 50)' --dt 0.05 --t-end 3 \
    --outcomes 'max(p_phi)' --picture

# Texts may have letters that XML has not, and markup.
printf '[scene]\ntitle = a\357\277\276 <b>&amp; ]]> "q"\n' >$work/odd.nevh
printf '[coordinates]\nx = 1\n[effects]\nT = p_x^2/2\nV = x^2/2\n[run]\nt_end = 5\n' >>$work/odd.nevh
printf 'dt = 0.1\nintegrators = verlet\n' >>$work/odd.nevh
draws 2 run $work/odd.nevh --plot
texts | grep -q 'a?* &lt;b&gt;&amp;amp; \]\]&gt; &quot;q&quot;$' ||
    { fails "has another title"; texts | head -n 1; }

# A report has them all, and asks for no gnuplot either.
exits 0 report pendulum -o $work/page.html --t-end 5
test "$(grep -c '<svg class="broad"' $work/page.html)" = 4 || fails "has other pictures"
test "$(grep -c '<svg class="narrow"' $work/page.html)" = 4 || fails "has other small pictures"
test -e $work/asked && fails "asks gnuplot"
exits 2 run pendulum --t-end 5 --plot $work/out.png
says 'gnuplot failed'
test -e $work/asked || fails "draws a PNG without gnuplot"
exit $status

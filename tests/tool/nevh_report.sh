#!/bin/sh
# nevh report: one page of HTML that fetches nothing.

. "${srcdir:-.}/tests/support/nevh_support.sh"

page=$work/page.html

# What is wrong is said, and there is no page.
refused 'takes scenes' report -o $page
refused 'needs a file' report pendulum
refused 'no scene|cannot be read|there is no' report no-such-scene -o $page
refused 'no option of nevh report' report pendulum -o $page --format csv
refused 'cannot be written' report pendulum -o $work/no/folder.html

printf '[coordinates\n' >$work/bad.nevh
refused 'bad\.nevh:1' report $work/bad.nevh -o $page
refused 'no integrator has a row' report double-pendulum -o $page \
    --integrators verlet --t-end 1

printf '%s\n' '[scene]' 'title = A <b> & "c"' 'effects = K, V' '[coordinates]' 'x = 1' 'y = 0' \
    '[effects]' 'K = (p_x^2 + p_y^2)/2' 'V = (x^2 + y^2)/2' 'W = x^4' '[run]' \
    't_end = 5' 'dt = 0.1' 'integrators = verlet, rk4' \
    >$work/own.nevh
TMPDIR=$work exits 0 report $work/own.nevh pendulum -o $page --t-end 5
test -s $work/err && { fails "prints messages"; cat $work/err; }
ls $work | grep -q '^nevh\.' && fails "leaves its folder"

# Nor where a signal comes while a part is made.
command="report own.nevh (TERM)"
mkdir $work/parts
TMPDIR=$PWD/$work/parts "$nevh" report $work/own.nevh -o $work/never.html --t-end 100000 \
    --dt 0.001 >$work/out 2>$work/err </dev/null &
reporting=$!
until test -n "$(ls $work/parts)"; do
    kill -0 $reporting 2>/dev/null || { fails "makes no part"; break; }
    sleep 0.1
done
kill -s TERM $reporting
wait $reporting 2>/dev/null
test $? -gt 128 || fails "goes on after a signal"
ls $work/parts | grep . && fails "leaves its files"
test -e $work/never.html && fails "leaves its page"
cp $page $work/out
has '^<!DOCTYPE html>'
has '<h1>A &lt;b&gt; &amp; &quot;c&quot;</h1>'
has '<dd class="off" tabindex="0">\(off\) <math'
lacks '(src|href)="[^#]'
lacks 'https?://[^w]'
lacks '[^a-z]nan[^a-z]'
lacks '<p></p>'
has '<title>nevh report: .*own\.nevh, pendulum</title>'
for heading in 'The Hamiltonian' 'Energy errors' 'The motion' 'Phase plane' \
    Portrait 'Order and chaos' 'What accuracy costs'; do
    has "<h2>$heading</h2>"
done
# The contents link to all parts, which have one heading each; facts are a table.
sed -n 's/.*<a href="#\(part[0-9]*\)">\([^<]*\)<.*/\1 \2/p' $page >$work/links
sed -n '/<section id=/{s/.*id="\(part[0-9]*\)".*/\1/;N;s/\n<h2>\(.*\)<\/h2>/ \1/;p;}' $page |
    cmp -s - $work/links || fails "has other contents"
test "$(grep -c part $work/links)" -gt 8 || fails "has few contents"
test "$(grep -c '<table class="facts">' $page)" = 2 || fails "has no facts"
has '<th scope="row">H</th><td>T\(p\) \+ V\(q\)</td>'
lacks '<p>(gradient: central4|H = |t = 0)'
# Dark pictures: each colour of integrators has another on black.
for colour in $(sed -n 's/^    X("\(#[0-9A-F]*\)", "\(#[0-9A-F]*\)") .*/\1:\2/p' "$srcdir/tools/plot/looks.h"); do
    has "figure \[stroke='${colour%:*}'\]\{stroke:${colour#*:}\}"
done
# By default a scene has what says something, and not too much of it.
exits 0 report pendulum -o $work/usual.html --t-end 20
exits 0 report pendulum-periods -o $work/many.html --t-end 20
for one in usual many; do
    test "$(wc -c <$work/$one.html)" -le 300000 || fails "has $(wc -c <$work/$one.html) bytes"
done
cp $work/usual.html $work/out
for heading in Sections 'Phase plane' Effects Gradients 'Properties of H'; do
    lacks "<h2>$heading</h2>"
done
has 'nevh portrait pendulum .*--vary .*phi = range\('
exits 0 report pendulum -o $work/usual.html --t-end 20 --all
cp $work/usual.html $work/out
for heading in Sections 'Phase plane' Effects Gradients 'Properties of H'; do
    has "<h2>$heading</h2>"
done
for element in section figure svg table math dl main; do
    opened=$(grep -o "<$element[ >]" $page | wc -l)
    closed=$(grep -o "</$element>" $page | wc -l)
    test "$opened" -gt 0 && test "$opened" = "$closed" ||
        fails "has $opened <$element> and $closed </$element>"
done
grep -Eo "[ <](id)=['\"][^'\"]*" $page | sort | uniq -d | grep -q . &&
    fails "names two things alike"
# Dots of an orbit are one path.
test "$(grep -c '<path' $page)" -lt 2000 || fails "has an element a dot"
grep -q "stroke-linecap='round'" $page || fails "has no dots"

# The command that a part names makes its numbers.
line=$(sed -n 's/^<p>Made by <code>nevh \(compare pendulum.*\)<\/code>.*/\1/p' \
    $page | sed "s/'//g")
test -n "$line" || fails "has no command"
exits 0 $line
energies=$(awk '$1 == "verlet" || $1 == "gauss4" { print $5 }' $work/out)
test -n "$energies" || fails "has no energies"
for number in $energies; do
    grep -q "<td class=\"number\">$number</td>" $page || fails "lacks $number"
done


# Variants stand side by side; each names the commands that make its numbers, which
# are not those of the other.
exits 2 report pendulum -o $work/none.html --variant nothing=1
says 'nothing'
test -e $work/none.html && fails "writes a page"
exits 2 compare pendulum --variant l=1
says 'no option of nevh compare'
exits 0 report pendulum -o $work/variants.html --variant l=1 --variant l=2,m=3 \
    --set g=9 --t-end 2
cp $work/variants.html $work/out
has '<h1>Pendulum[^<]*, but g=9</h1>'
has '<h2>Energy errors: l=1</h2>'
has '<h2>Energy errors: l=2,m=3</h2>'
has '<code>nevh compare pendulum --set g=9 --set l=2 --set m=3 --t-end 2</code>'
test "$(grep -c '<div class="variants">' $work/variants.html)" = \
    "$(grep -c '<h2>.*: l=1</h2>' $work/variants.html)" || fails "does not pair variants"
for set in '--set l=1' '--set l=2 --set m=3'; do
    exits 0 compare pendulum --set g=9 $set --t-end 2
    scale=$(sed -n 's/^energy_scale: \([0-9.]*\).*/\1/p' $work/out)
    test "$(grep -c "<th scope=\"row\">energy_scale</th><td>$scale " $work/variants.html)" = 1 ||
        fails "has not the energy $scale of $set"
done

# What moves: a still picture without scripts, steps on demand; its numbers are
# those of the command beside it.
film=$work/film
sed -n '/<h1>Pendulum/,$p' $page |
    sed -n '/<h2>A symplectic scheme beside rk4/,/<\/section>/p' >$film
grep -q '<title>The motion by ' $film && grep -q '<desc>' $film || fails "has no film"
grep -q 'prefers-reduced-motion' $film || fails "moves against the reader's will"
grep -q 'class="controls" hidden' $film || fails "has controls without a script"
grep -Eq '<span class="stamp">step 400, t = [0-9.]+</span> s' $film ||
    fails "has no stamp"
test "$(wc -c <$film)" -lt 150000 || fails "has a large film"
numbers=$(sed -n 's/.*"places":\[\[\(.*\)\],*$/\1/p' $film | tr , '\n' | wc -l)
test "$numbers" = $((401 * 6)) || fails "has $numbers numbers of places"
line=$(sed -n 's/^<p>The same runs: <code>nevh \(.*\)<\/code>.*/\1/p' $film)
exits 0 $line
most=$(sed -n 's/.*error of [a-z0-9-]* stays within \([0-9.]*\) %.*/\1/p' $film |
    awk '{ printf "%.1e", $1/100 }')
awk -v most="$most" '$2 == 2 && $5 == most { found = 1 } 
    $1 == "rk4" && $NF == "drifts" { lost = 1 } END { exit !(found && lost) }' $work/out ||
    { fails "has a film with other numbers than $most"; cat $work/out; }

# The whole way of each body is in it, and some step between two is found where rk4
# loses energy at neither, or all of it.
test "$(grep -c '<path fill="none" .* d="M[0-9]*,' $film)" = 2 || fails "shows no ways"
exits 0 report outer-solar-system -o $work/planets.html --t-end 2000
grep -q 'rk4 has then lost .* of the energy scale' $work/planets.html ||
    fails "shows no loss of rk4"
test "$(grep -o '<circle r="[0-9]*" fill="[^"]*' $work/planets.html | cut -d'"' -f4 | uniq -c |
    awk '{ printf "%s ", $1 }')" = '6 6 ' || fails "gives a body the colour of another scheme"

# Levels of H say nothing of driven orbits, nor is a scheme symplectic with friction.
exits 0 report damped-driven-pendulum -o $work/driven.html --t-end 5
grep -q '<h2>Sections</h2>' $work/driven.html || fails "has no sections"
grep -q '<h2>Portrait</h2>' $work/driven.html && fails "has levels of an H of time"
grep -q 'scheme beside rk4' $work/driven.html && fails "calls a damped scheme symplectic"

# There is no film where steps that tell nothing leave no orbit to be seen.
exits 0 report earth-halley -o $work/halley.html --t-end 10
grep -q '<h2>The motion</h2>' $work/halley.html || fails "has no picture"
grep -q 'scheme beside rk4' $work/halley.html && fails "shows what is no orbit"

# Where parts have no room, it says so, and writes no page.
(
    trap '' XFSZ
    ulimit -f 0
    "$nevh" report oscillator -o $work/none.html --t-end 1 2>&1
    echo "status $?"
) | cat >$work/said
grep -q 'cannot be written: is the disk full' $work/said && grep -q '^status 2' $work/said ||
    { fails "does not say that the disk is full"; cat $work/said; }
test ! -e $work/none.html || fails "writes a page without room"

# Nor where some parts have room: a picture, or a message, is not left out in silence.
"$nevh" report oscillator -o $work/all.html --t-end 1 --dt 0.1 2>/dev/null
pictures=$(grep -c '<svg' $work/all.html)
for blocks in 8 12 16 24 32 48; do
    (
        trap '' XFSZ
        ulimit -f $blocks
        "$nevh" report oscillator -o /dev/stdout --t-end 1 --dt 0.1 2>$work/err
        echo "status $?"
    ) | cat >$work/said
    case $(tail -n 1 $work/said) in
    'status 0') test "$(grep -c '<svg' $work/said)" = "$pictures" ||
        fails "leaves out what files of $blocks blocks have no room for" ;;
    'status 2') grep -q 'is the disk full' $work/err || fails "does not say why" ;;
    *) fails "ends otherwise: $(cat $work/err)" ;;
    esac
done

# An orbit without any energy error has a report, though no curve of it.
printf '[coordinates]\nx = 0\n[effects]\nK = p_x^2/2\nV = x^2/2\n[run]
t_end = 2\ndt = 0.1\nintegrators = verlet\n' >$work/rest.nevh
exits 0 report $work/rest.nevh -o $work/rest.html
grep -q '<td class="number">0.0e+00</td>' $work/rest.html ||
    fails "lacks the errors, which are 0"
exit $status

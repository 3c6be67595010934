#!/bin/sh
# nevh page: one file that fetches nothing.

. "${srcdir:-.}/tests/support/nevh_support.sh"

page=$work/page.html

# What is wrong is said, and there is no page.
refused 'needs a file' page pendulum
refused 'no scene|there is no' page no-such-scene -o $page
refused 'needs a scene' page -o $page
refused 'no option of nevh page' page pendulum -o $page --format csv
refused 'needs GSL' page pendulum -o $page --integrators gsl-rkf45
refused 'needs GSL' page pendulum -o $page --integrators verlet,tao4
refused 'no transforms' page kepler -o $page --integrators midpoint+transform
refused 'unknown integrator verlett' page pendulum -o $page --integrators verlett
refused 'up to 4' page pendulum -o $page --integrators euler,rk4,verlet,gauss4,gauss6
printf '[coordinates\n' >$work/bad.nevh
refused 'bad\.nevh:1' page $work/bad.nevh -o $page
printf '%s\n' '[coordinates]' 'x = 0' '[effects]' 'K = p_x^2/2' 'V = 1/x' >$work/bad.nevh
refused 'not finite' page $work/bad.nevh -o $page

if ! test -f web/kit.html && ! test -f "$srcdir/web/kit.html"; then
    refused 'built without the live page' page pendulum -o $page
    echo "there is no web/kit.html: make page was not run"
    test $status = 0 && exit 77
    exit 1
fi
refused '--dt: ' page pendulum -o $page --dt=-1
refused 'cannot be written' page pendulum -o $work/no/folder.html

# A title that would end the element that it is in.
printf '%s\n' '[scene]' 'title = A </script><b> & "c" \' '[parameters]' 'k = 1' \
    '[coordinates]' 'x = 1' '[effects]' 'K = p_x^2/2' 'V = k*x^2/2' 'W = x^4' \
    >$work/own.nevh
exits 0 page $work/own.nevh -o $page --set k=2.5 --without W --start x=3 \
    --dt 1/8 --integrators rk4,verlet
test -s $work/err && { fails "prints messages"; cat $work/err; }
cp $page $work/out
has '^<!DOCTYPE html>'
lacks '@SCENE@'
lacks '(src|href)="'
lacks '@import|url\('
lacks 'https?://'
has '"dt":0.125'
has '"changes":\[\["@","x=3"\]\]'
has '"integrators":\["rk4","verlet"\]'
has 'k = 2\.5'
has 'A \\u003c/script\\u003e\\u003cb\\u003e \\u0026 \\u0022c\\u0022'
for element in script figure section main table; do
    opened=$(grep -v '^\[*{"name"' $page | grep -o "<$element[ >]" | wc -l)
    closed=$(grep -v '^\[*{"name"' $page | grep -o "</$element>" | wc -l)
    test "$opened" -gt 0 && test "$opened" = "$closed" ||
        fails "has $opened <$element> and $closed </$element>"
done

# Several scenes in one page; none where one of them is wrong.
exits 0 page pendulum $work/own.nevh -o $page
cp $page $work/out
has '^\[\{"name":"pendulum",'
has '^\{"name":"[^"]*own.nevh",'
rm $page
refused 'psi' page pendulum $work/own.nevh --set psi=1 -o $page
test ! -e $page || fails "leaves a page"

# The same scene gives the same page; a page is not large.
exits 0 page pendulum -o $page
cp $page $work/first.html
exits 0 page pendulum -o $page
cmp -s $page $work/first.html || fails "differs from run to run"
for scene in sun-earth-moon outer-solar-system; do # those with the most text
    exits 0 page $scene -o $page
    size=$(wc -c <$page)
    test $size -le 300000 || fails "is of $size bytes"
done

exit $status

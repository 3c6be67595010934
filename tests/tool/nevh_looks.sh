#!/bin/sh
# Looks of integrators that stand together in a scene, or are often compared, are told
# apart by eyes that see few colours, and in grey; all are seen on white and on black.

. "${srcdir:-.}/tests/support/nevh_support.sh"

command="looks"
cat >$work/looks.awk <<'END'
function hex(text) { return 16*index(digits, substr(text, 1, 1)) + index(digits, substr(text, 2, 1)) - 17 }
function linear(c) { c /= 255; return c <= 0.04045 ? c/12.92 : ((c + 0.055)/1.055)^2.4 }
function read(colour, rgb, i) { for (i = 0; i < 3; i++) rgb[i] = linear(hex(substr(colour, 2 + 2*i))) }
function root(t) { return t > 0.008856 ? t^(1/3) : 7.787*t + 16/116 }
function unit(c) { return c < 0 ? 0 : c > 1 ? 1 : c }
# The colour as that eye sees it, in CIELAB.
function see(colour, eye, lab, c, s, i, x, y, z) {
    read(colour, c)
    for (i = 0; i < 3; i++)
        s[i] = unit(m[eye, 3*i + 1]*c[0] + m[eye, 3*i + 2]*c[1] + m[eye, 3*i + 3]*c[2])
    x = root((0.4124*s[0] + 0.3576*s[1] + 0.1805*s[2])/0.9505)
    y = root(0.2126*s[0] + 0.7152*s[1] + 0.0722*s[2])
    z = root((0.0193*s[0] + 0.1192*s[1] + 0.9505*s[2])/1.089)
    lab[0] = 116*y - 16; lab[1] = 500*(x - y); lab[2] = 200*(y - z)
}
function apart(a, b, eye, p, q) {
    see(a, eye, p); see(b, eye, q)
    return sqrt((p[0] - q[0])^2 + (p[1] - q[1])^2 + (p[2] - q[2])^2)
}
function luminance(colour, c) { read(colour, c); return 0.2126*c[0] + 0.7152*c[1] + 0.0722*c[2] }
function contrast(a, b, x, y) {
    x = luminance(a); y = luminance(b)
    return x > y ? (x + 0.05)/(y + 0.05) : (y + 0.05)/(x + 0.05)
}
function check(a, b, side, eye, i, distance) {
    if (a == b || (a, b) in checked) return
    checked[a, b]; checked[b, a]
    pairs++
    if (look[a] % colours == look[b] % colours)
        print a, b, "share a colour"
    for (side = 1; side <= 2; side++)
        for (i = 1; i <= 4; i++) {
            eye = eyes[i]
            distance = apart(colour[side, look[a] % colours], colour[side, look[b] % colours], eye)
            # Curves without marks differ in dashes where they do not in colour.
            if (distance < least && look[a] % dashes == look[b] % dashes)
                print eye, side == 1 ? "on white:" : "on black:", a, b, distance, "in lines"
            if (distance < least && eye != "grey" && look[a] % colours != look[b] % colours)
                print eye, a, b, distance, "in colour"
        }
}
BEGIN {
    digits = "0123456789ABCDEF"
    # G. M. Machado, M. M. Oliveira, L. A. F. Fernandes, IEEE Trans. Vis. Comput. Graph.
    # 15 (2009) 1291-1298, severity 1.
    eyes[1] = "protanopia"; eyes[2] = "deuteranopia"; eyes[3] = "tritanopia"; eyes[4] = "grey"
    row[1] = ".152286 1.052583 -.204868 .114503 .786281 .099216 -.003882 -.048116 1.051998"
    row[2] = ".367322 .860646 -.227968 .280085 .672501 .047413 -.011820 .042940 .968881"
    row[3] = "1.255528 -.076749 -.178779 -.078411 .930809 .147602 .004733 .691367 .303900"
    row[4] = ".2126 .7152 .0722 .2126 .7152 .0722 .2126 .7152 .0722"
    for (i = 1; i <= 4; i++) {
        split(row[i], part, " ")
        for (k = 1; k <= 9; k++) m[eyes[i], k] = part[k]
    }
    least = 10 # of 100 from black to white
    dashes = 5
}
/^    X\("#/ { split($0, field, "\""); colour[1, colours + 0] = field[2]; colour[2, colours++ + 0] = field[4]; next }
/^    X\("/ { split($0, field, "\""); look[field[2]] = looks++; often[looks] = field[2]; next }
/^integrators *=|--integrators [a-z]/ {
    sub(/.*(= *|--integrators )/, ""); sub(/, +/, ",", $0); sub(/ .*/, "")
    n = split($0, name, ",")
    for (i = 1; i <= n; i++)
        for (k = 1; k < i; k++)
            if ((name[i] in look) && (name[k] in look)) check(name[i], name[k])
}
END {
    for (i = 1; i <= 8; i++)
        for (k = 1; k < i; k++) check(often[i], often[k])
    for (i = 0; i < colours; i++) {
        if (contrast(colour[1, i], "#FFFFFF") < 3) print colour[1, i], "is lost on white"
        if (contrast(colour[2, i], "#17171B") < 3) print colour[2, i], "is lost on black"
    }
    if (pairs < 28) print "only", pairs + 0, "pairs"
}
END
seen() { # LOOKS
    awk -f $work/looks.awk "$1" "$srcdir"/scenes/*.nevh "$srcdir"/doc/sheets/*.texi >$work/out
}
seen "$srcdir/tools/plot/looks.h"
test -s $work/out && { fails "are alike"; cat $work/out; }
# Contrast: such colours would be found.
sed 's/"#CB5500"/"#00A070"/' "$srcdir/tools/plot/looks.h" >$work/alike.h
seen $work/alike.h
grep -q 'protanopia .*in colour' $work/out || fails "do not find equal colours"
sed 's/"#CA8600"/"#F0E442"/' "$srcdir/tools/plot/looks.h" >$work/yellow.h
seen $work/yellow.h
grep -q '#F0E442 is lost on white' $work/out || fails "do not find yellow on white"
exit $status

#!/bin/sh
# The manual and the README: each command in them runs, and the catalogue of
# integrators has what the registry has.  A command below "@c slow: WHY" runs where
# SLOW is set; one below "@c elsewhere: WHY" needs what is not here.

. "${srcdir:-.}/tests/support/nevh_support.sh"

case $srcdir in
/*) top=$srcdir ;;
*) top=$PWD/$srcdir ;;
esac
NEVH_SCENES=$top/scenes
test "${nevh#/}" != "$nevh" || nevh=$PWD/$nevh
cp "$top"/doc/*.nevh $work/

# A line a command, without "nevh" and what is said beside it.
list_commands() {
    awk -v slow="${SLOW:-}" '
        function command(text) {
            gsub(/@@/, "@", text)
            gsub(/@\{/, "{", text)
            gsub(/@\}/, "}", text)
            sub(/^\.\//, "", text)
            sub(/    *.*$/, "", text)
            sub(/ *#.*$/, "", text)
            if (text ~ /^nevh [a-z]/ && text !~ /[A-Z][A-Z][A-Z]|\.\.\.|^nevh help/)
                print substr(text, 6)
        }
        FNR == 1 { inside = leave = 0; text = "" }
        /^@c slow: / { leave = !slow }
        /^@c elsewhere: / { leave = 1 }
        /^@example/ || /^```/ && !inside { inside = 1; next }
        /^@end example/ || /^```/ { inside = leave = 0; next }
        inside && !leave {
            more = /\\$/
            line = $0
            sub(/ *\\$/, "", line)
            if (text != "")
                sub(/^ */, " ", line)
            text = text line
            if (more)
                next
            command(text)
            text = ""
        }' "$@" | awk '!seen[$0]++'
}
list_commands "$top"/doc/*.texi "$top/README.md" >$work/commands
test "$(wc -l <$work/commands)" -ge 20 ||
    { command=manual; fails "has few commands: $(wc -l <$work/commands)"; }

while IFS= read -r command; do
    case $command in
    *.png* | *.pdf* | *.gif* | *--plot\ -*)
        command -v gnuplot >/dev/null 2>&1 || continue ;;
    *names.txt* | *answers.csv*) continue ;; # of a class
    sheet*)
        "$nevh" sheet >/dev/null 2>&1 || continue ;; # Python
    *page\ *)
        test -e "$top/web/kit.html" || continue ;; # make page makes it
    esac
    (cd $work && eval "set -- $command" && $limit "$nevh" "$@") \
        >$work/out 2>$work/err </dev/null ||
        { fails "exit status $?"; cat $work/err; }
done <$work/commands

# The tables that the manual quotes have the numbers of today: all
# columns of each row but milliseconds, which stand last but one.  Counts of implicit
# schemes depend a little on the sines of the machine.
rows_of() {
    awk '$3 ~ /^(yes|no|extended)$/ && NF > 7 { $(NF - 1) = ""; print }' "$1"
}
for quoted in compare-first compare-pendulum; do
    command=$(sed -n '1s/^\$ nevh //p' "$top/doc/$quoted.txt")
    (cd $work && eval "set -- $command" && $limit "$nevh" "$@") \
        >$work/out 2>$work/err </dev/null || fails "exit status $?"
    rows_of $work/out >$work/rows
    test -s $work/rows || fails 'prints no rows'
    rows_of "$top/doc/$quoted.txt" | paste -d ' ' $work/rows - | awk '
        { half = NF / 2
          for (i = 1; i <= half; i++) {
              a = $i; b = $(i + half)
              counts = a ~ /^[0-9]+k$/ && b ~ /^[0-9]+k$/
              if (counts ? (a + 0) / (b + 0) > 1.02 || (a + 0) / (b + 0) < 0.98 : a != b) {
                  print; wrong = 1; next
              }
          } }
        END { exit wrong }' ||
        fails "has other numbers than doc/$quoted.txt: make figures"
done
command='list integrators'
$limit "$nevh" list integrators --format csv >$work/out 2>$work/err </dev/null ||
    fails "exit status $?"
awk -F, '!/^#/ && $1 != "integrator" && $1 != "name" { print $1 }' $work/out |
    sort >$work/registry
sed -n '/@table/,/@end table/s/^@item //p' "$top/doc/catalogue.texi" |
    sort >$work/catalogue
diff $work/registry $work/catalogue ||
    fails "has other schemes than doc/catalogue.texi: make figures"
exit $status

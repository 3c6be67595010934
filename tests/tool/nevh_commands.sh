#!/bin/sh
# nevh help --format json: valid, and the same as what nevh takes, prints and what
# the manual describes.

. "${srcdir:-.}/tests/support/nevh_support.sh"

exits 0 help --format json
cp $work/out $work/all
exits 0 --format json --help
cmp -s $work/out $work/all || fails "differs from nevh help --format json"
commands=$(sed -n 's/^ *{"name": "\([a-z]*\)", "operand": .*/\1/p' $work/all)
options=$(sed -n 's/^ *{"name": "\([a-z-]*\)", "letter": .*/\1/p' $work/all)
command='help --format json'
test "$(echo "$commands" | wc -l)" -ge 22 || fails "has few commands"
test "$(echo "$options" | wc -l)" -ge 60 || fails "has few options"
if command -v python3 >/dev/null 2>&1; then
    for one in '' $commands; do
        exits 0 help $one --format json
        python3 -m json.tool $work/out >/dev/null || fails "is no JSON"
    done
fi
exits 2 help --format csv
says 'with --format json'

# The rows of the table of options, in their order, and no other.
sed -n '/^const option_row option_rows/,/^};/s/^    {"\([a-z-]*\)".*/\1/p' \
    "$srcdir/tools/cli/options.c" >$work/rows
test -s $work/rows || fails "finds no table of options"
echo "$options" | diff - $work/rows || fails "has other options than the table"

# An argument for each kind, as words of a command line.
argument() {
    sed -n "s/^ *{\"name\": \"$1\", \"letter\": .*\"kind\": \"\([a-z-]*\)\", \"words\": \(\[\"\([^\"]*\)\)\{0,1\}.*/\1 \3/p" \
        $work/all | while read -r kind word; do
        case $kind in
        flag) ;;
        choice) echo "$word" ;;
        part) echo 1/2 ;;
        settings | assignments | assignment) echo a=1 ;;
        *) echo 1 ;;
        esac
    done
}
# A command takes all the options that its line has.
missing=$work/missing.nevh
for one in compare run chaos sweep flow reference export section; do
    set --
    exits 0 help $one --format json
    for option in $(sed -n 's/^ *{"name": "\([a-z-]*\)", "letter": .*/\1/p' $work/out); do
        case $option in
        help | version) continue ;;
        plot-kind) value=$(sed -n 's/^ *"plot_kinds": \["\([a-z]*\)".*/\1/p' $work/out) ;;
        *) value=$(argument $option) ;;
        esac
        set -- "$@" --$option $value
    done
    exits 2 $one $missing "$@"
    grep -q 'unknown option\|no option of\|--plot-kind\|an argument\|: --[a-z-]* takes' \
        $work/err && { fails "does not take one of $*"; cat $work/err; }
done
# And no other: an option is refused by the first command that lacks it.
lists_option() {
    sed -n "/^ *{\"name\": \"$1\", \"operand\"/,/\"options\"/p" $work/all |
        grep -q "\"options\": .*\"$2\""
}
for option in $options; do
    for one in list new hard reference; do
        lists_option $one $option && continue
        exits 2 $one --$option $(argument $option)
        says "^nevh: --$option is no option of nevh $one"
        break
    done
done

# Tables begin with the columns of their commands.
columns_of() {
    sed -n "/^ *{\"name\": \"$1\", \"operand\"/,/\"columns\"/p" $work/all |
        sed -n 's/^ *"columns": \[\(.*\)\],$/\1/p' | sed 's/"//g; s/, /,/g'
}
begins() {
    columns=$(columns_of $1)
    test "$columns" || fails "has no columns of $1"
    exits 0 "$@" --format csv --quiet
    case "$(head -n 1 $work/out)," in
    "$columns",*) ;;
    *) fails "begins not with $columns: $(head -n 1 $work/out)" ;;
    esac
}
begins compare pendulum --t-end 1 --integrators verlet
begins run pendulum --t-end 1
begins cost oscillator --t-end 5 --integrators verlet
begins recommend oscillator --t-end 5 --energy-error 1e-2 --integrators verlet
begins gradients pendulum --t-end 1
begins check pendulum --t-end 1
begins effects pendulum --t-end 1
begins section pendulum --t-end 20
begins chaos pendulum --t-end 20 --starts 2
begins sweep pendulum --t-end 1 --vary 'phi = range(1, 2, 2)' --outcomes t
begins frequencies pendulum --t-end 100 --integrators verlet
begins flow pendulum --integrators verlet --at 1
begins reference pendulum --at 1
grep -q '"columns": \["scene", "integrator"' $work/all || fails 'has no columns'

# The manual has each command and each option, and no option that is none.
command=doc/nevh.texi
manual=$srcdir/doc/nevh.texi
sed -n '/^@node The command$/,/^@end table/s/^@itemx* \([a-z]*\)$/\1/p' "$manual" |
    sort >$work/described
echo "$commands" | sort | diff $work/described - ||
    fails "describes other commands than nevh help"
for option in $options; do
    grep -Eq -e "(^@itemx* |@option\{|, )--$option([ },=]|\$)" "$manual" ||
        fails "lacks --$option"
done
sed -n '/^@section Options$/,/^@end table/s/^@itemx* .*--\([a-z-]*\).*/\1/p' \
    "$manual" | while read -r option; do
    echo "$options" | grep -qx -e "$option" || echo "$option"
done >$work/none
test -s $work/none && { fails "describes what is no option:"; cat $work/none; }
exit $status

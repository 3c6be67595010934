# What tests of the command share, to be sourced: runs nevh in a folder of its
# own, $work, and counts what is wrong in $status.

srcdir=${srcdir:-.}
NEVH_SCENES=$srcdir/scenes
export NEVH_SCENES
. "$srcdir/tests/support/nevh_command.sh"
limit=
command -v timeout >/dev/null 2>&1 &&
    limit="timeout ${CK_DEFAULT_TIMEOUT:-600}"

work=nevh-$(basename "$0" .sh).$$
trap 'rm -rf $work' EXIT
trap 'exit 1' HUP INT TERM
mkdir $work || exit 1

status=0
fails() {
    echo "nevh $command: $1"
    status=1
}

# exits STATUS ARGUMENT...: runs nevh.
exits() {
    expected=$1
    shift
    command=$*
    $limit "$nevh" "$@" >$work/out 2>$work/err </dev/null
    code=$?
    test $code = "$expected" ||
        { fails "exit status $code instead of $expected"; cat $work/err; }
}
says() {
    grep -Eq -e "$1" $work/err || { fails "does not say '$1'"; cat $work/err; }
}
# refused PATTERN, ARGUMENT...: bad input, which leaves no $page.
refused() {
    pattern=$1
    shift
    exits 2 "$@"
    says "$pattern"
    test ! -e $page || fails "leaves a page"
}
# all_digits: CSV with numbers of 17 digits, as exported programs print them; nevh
# prints the shortest that read back.
all_digits() {
    awk -F, '{ for (i = 1; i <= NF; i++)
        printf("%s%s", $i ~ /^-?[0-9.]/ ? sprintf("%.17g", $i) : $i,
            i < NF ? "," : "\n") }'
}
has() {
    grep -Eq -e "$1" $work/out || { fails "lacks '$1'"; cat $work/out; }
}
lacks() {
    grep -Eq -e "$1" $work/out && { fails "has '$1'"; cat $work/out; }
}
# in_browsers PROGRAM ARGUMENT: runs tests/support/PROGRAM in each browser that is here.
in_browsers() {
    command -v node >/dev/null 2>&1 || {
        echo "pages are tried with node, which is not here"
        exit 77
    }
    tried=
    for names in 'chromium chromium-browser google-chrome' 'firefox-esr firefox'; do
        browser=
        for one in $names; do
            command -v $one >/dev/null 2>&1 && browser=$one && break
        done
        test -n "$browser" || { echo "not tried in ${names##* }: it is not here"; continue; }
        tried=yes
        $limit node "$srcdir/tests/support/$1" $browser "$2" >$work/tried 2>&1 ||
            fails "is wrong in $browser"
        cat $work/tried
    done
    test $status = 1 || test -n "$tried" || exit 77
}
# In the SVG that was drawn last, texts one a line.
texts() {
    sed -n 's/.*<text[^>]*>\(.*\)<\/text>.*/\1/p' $svg | sed 's/<[^>]*>//g'
}

# What tests of the command share, to be sourced: runs nevh in a folder of its
# own, $work, and counts what is wrong in $status.

srcdir=${srcdir:-.}
NEVH_SCENES=$srcdir/scenes
export NEVH_SCENES
nevh=${NEVH:-./tools/nevh}
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
has() {
    grep -Eq -e "$1" $work/out || { fails "lacks '$1'"; cat $work/out; }
}
lacks() {
    grep -Eq -e "$1" $work/out && { fails "has '$1'"; cat $work/out; }
}

# For tests that interrupt the command at places they ask for; to be sourced after
# nevh_support.sh.  tests/support/interrupt.c comes between it and a shared libnevh.

TERM=15
KILL=9

# stop SIGNAL WHERE ARGUMENT...: runs nevh until that signal comes; whether it did.
# WHERE is INTERRUPT_STEP=k or INTERRUPT_WRITE=k, as tests/support/interrupt.c says.
stop() {
    signal=$1
    where=$2
    shift 2
    command="$* ($where)"
    rm -f $work/sign
    (
        LD_PRELOAD=$PWD/$work/interrupt.so
        INTERRUPT_SIGN=$work/sign
        INTERRUPT_SIGNAL=$signal
        ASAN_OPTIONS=$ASAN_OPTIONS:verify_asan_link_order=0
        export LD_PRELOAD INTERRUPT_SIGN INTERRUPT_SIGNAL ASAN_OPTIONS $where
        "$nevh" "$@" >/dev/null 2>$work/err
        exit $?
    ) 2>/dev/null
    code=$?
    test $code -gt 128 && test -e $work/sign
}
must_stop() {
    stop "$@" || { fails "was not interrupted (exit status $code)"; cat $work/err; }
}

# Whether that is possible here; $why not.
can_stop() {
    why='there is no C compiler'
    command -v ${CC:-cc} >/dev/null 2>&1 || return
    why='tests/support/interrupt.c does not compile'
    ${CC:-cc} -shared -fPIC -I"$srcdir/include" -o $work/interrupt.so \
        "$srcdir/tests/support/interrupt.c" -ldl 2>$work/err || return
    why='nevh does not call a shared libnevh'
    stop $TERM INTERRUPT_STEP=2 run pendulum -o $work/trial.csv
}
# Ends a test whose interruptions are left out, which counts as skipped.
exits_whole() {
    test $status = 0 || exit $status
    echo "interruptions were not tested: $why"
    exit 77
}

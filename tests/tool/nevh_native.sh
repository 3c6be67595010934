#!/bin/sh
# Steps that commands compile: tables have the same numbers with them, and say
# which ran; short runs compile nothing; without a compiler, or when the command
# is killed, nothing else changes.

. "${srcdir:-.}/tests/support/nevh_support.sh"

${CC:-cc} --version >/dev/null 2>&1 || exit 77
XDG_CACHE_HOME=${XDG_CACHE_HOME:-$PWD/$work/kept}
TMPDIR=$PWD/$work/tmp
export XDG_CACHE_HOME TMPDIR
mkdir $TMPDIR
# But for seconds, their spread and what is compiled.
numbers() {
    grep -v '^#' $work/out | cut -d, -f 1-16,18,19
}
compiled() { # yes|no: how many rows
    grep -v '^#' $work/out | awk -F, -v x=$1 '$21 == x { n++ } END { print n + 0 }'
}
kept() {
    ls $cache/nevh 2>/dev/null | wc -l
}

# Every scheme, by a gradient of formulas and by one of values; what is compiled is kept
# for all tests.
every=$("$nevh" list integrators --all --format csv | grep -v '^#' |
    awk -F, 'NR > 1 { printf "%s%s", c, $1; c = "," }')
for scene in pendulum double-pendulum; do
    case $scene in pendulum) least=58 ;; *) least=26 ;; esac # schemes with compiled steps
    for gradient in exact central4; do
        for native in never always; do
            exits 0 compare $scene --portable --native $native --t-end 1 \
                --dt 0.02 --tolerance 1e-6 --gradient $gradient \
                --integrators "$every" --format csv
            numbers >$work/$native.csv
            test $native = never || break
            test $(compiled yes) = 0 || fails "compiles where it must not"
            lacks '^# native: steps of'
        done
        test $(compiled yes) -ge $least || fails "compiles $(compiled yes) schemes"
        has '^# native: steps of (verlet|.*gauss4)'
        cmp $work/never.csv $work/always.csv || fails "has other numbers"
    done
done
exits 0 compare pendulum --integrators verlet,verlet --dt 0.1,0.05 --t-end 1 \
    --native always
has '^native: all steps are compiled$'

# Nothing is compiled for short runs.
cache=$PWD/$work/cache
XDG_CACHE_HOME=$cache
long='--set g=9.7 --gradient exact --t-end 25000'
few='--set g=9.7 --gradient exact --t-end 5'
for what in 'compare pendulum --integrators verlet,gauss8' \
    'cost pendulum --integrators verlet,gauss8 --dt 0.1,0.05' \
    'recommend pendulum --energy-error 1e-4 --integrators verlet,gauss8' \
    'gradients pendulum'; do
    case $what in
    gradients*) exits 0 $what --t-end 5 ;;
    *) exits 0 $what $few ;;
    esac
    test $(kept) = 0 || fails "compiles for a short run"
    lacks 'native: '
done
exits 0 recommend pendulum --energy-error 1e-3
test $(kept) = 0 || fails "compiles what a single run would not"
lacks 'native: '

rm -rf $cache
# Those of long runs are, where all together pay: all of the table, or none.
exits 0 compare pendulum $long --integrators euler,verlet,gauss8,gonzalez --dt 0.1
test $(kept) = 3 || fails "keeps $(kept) compiled texts"
has '^native: steps of euler, verlet, gauss8 are compiled; others are not$'
rm -rf $cache
exits 0 compare pendulum $long --integrators euler,verlet --dt 0.1
test $(kept) = 0 || fails "compiles what does not pay"
exits 0 compare pendulum $long --integrators euler,gauss8 --dt 0.1
test $(kept) = 2 || fails "keeps $(kept) compiled texts"
# What the cache holds decides nothing.
exits 0 compare pendulum --set g=9.7 --gradient exact --t-end 1600 \
    --integrators verlet,ruth3 --dt 0.1
lacks 'native: '
exits 0 cost pendulum $long --integrators verlet,gauss8 --dt 0.1,0.2
has '^native: all steps are compiled$'
exits 0 recommend pendulum $long --integrators gauss8 --energy-error 1e-3 --dt 0.1
has '^native: all steps are compiled$'
exits 0 recommend pendulum $long --integrators gauss8 --energy-error 1e-3 \
    --dt 0.1 --native never
lacks 'native: '

# Members that differ in numbers of H go side by side, but not all by compiled steps.
of_eight='--integrators verlet --gradient exact --t-end 100000 --outcomes t'
exits 0 sweep pendulum --vary 'l = range(0.5, 2, 8)' $of_eight
has '^# native: steps are compiled$'
of_eight='--integrators gauss16 --gradient central4 --t-end 7000 --outcomes t'
exits 0 sweep pendulum --vary 'phi = range(0.5, 2, 8)' $of_eight
has '^# native: steps are compiled$'
exits 0 sweep pendulum --vary 'l = range(0.5, 2, 8)' $of_eight
has '^# native: steps are compiled where eight members or more have the same parameters$'
exits 0 sweep pendulum --vary 'l = range(0.5, 2, 8)' $of_eight --native always
has '^# native: steps are compiled$'

# What is found of orbits has the same bits with steps compiled or not, taken several at
# once or, beside an outcome that looks at each, one by one.
seen() { # OUTCOME: its column
    grep -v '^#' $work/out | awk -F, -v of="$1" '
        !at { for (i = 1; i <= NF; i++) if ($i == of) at = i }
        at { print $at }'
}
leaves() { # ARGUMENT...: members may fail, or all end well
    "$nevh" "$@" >$work/out 2>$work/err
    test $? -le 1 || fails "$* ends with $?"
}
sed '/^\[ensemble\]/,$d' ${srcdir:-.}/scenes/henon-heiles.nevh >$work/escapes.nevh
cat >>$work/escapes.nevh <<'SCENE'
[ensemble]
y   = range(-0.4, 1.3, 21)
p_x = 0.3
[run]
t_end = 41.03
stop  = x < -1.5
SCENE
for scheme in verlet taylor; do
    for outcomes in state lyapunov 'state,max(x),lyapunov,sali' \
        'energy_error,mean(x),frequency(x),first(x > 0.2)'; do
        test "$scheme:$outcomes" != taylor:lyapunov || continue
        for native in never always; do
            # Some escape, some stop, and steps of some fail.
            leaves sweep $work/escapes.nevh --integrators $scheme --dt 0.1 \
                --outcomes "$outcomes" --native $native
            grep -v '^#' $work/out >$work/$native.csv
            for of in x lyapunov; do
                seen $of >$work/seen
                test -s $work/seen || continue
                test -f $work/$scheme.$of || cp $work/seen $work/$scheme.$of
                cmp -s $work/seen $work/$scheme.$of ||
                    fails "$scheme: $of differs where $outcomes are asked for"
            done
        done
        cmp -s $work/never.csv $work/always.csv ||
            fails "$scheme: compiled steps give other $outcomes"
    done
done

# Without a compiler one line says so.
rm -rf $cache
for what in 'compare pendulum --integrators euler,gauss8 --dt 0.1' \
    'cost pendulum --integrators verlet,gauss8 --dt 0.1,0.2' \
    'recommend pendulum --integrators gauss8 --energy-error 1e-3 --dt 0.1'; do
    CC=no-such-compiler
    export CC
    exits 0 $what $long
    unset CC
    says '^nevh: steps are not compiled: there is no C compiler'
    test $(wc -l <$work/err) = 1 || fails "says more than a line"
    lacks 'native: '
done
test "$(ls -A $TMPDIR)" = '' || fails "leaves $(ls -A $TMPDIR)"

# Compilers of a table work side by side: here each waits for another.
if test "$(getconf _NPROCESSORS_ONLN)" -gt 1; then
    cat >$work/together <<'END'
#!/bin/sh
touch "$MET/$$"
for i in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20; do
    test "$(ls "$MET" | wc -l)" -gt 1 && touch "$MET.met" && break
    sleep 1
done
exec ${C_COMPILER:-cc} "$@"
END
    chmod +x $work/together
    mkdir $work/at-work
    C_COMPILER=$CC MET=$PWD/$work/at-work CC=$PWD/$work/together
    export C_COMPILER MET CC
    exits 0 compare pendulum $long --integrators euler,verlet,gauss8,gonzalez --dt 0.1
    unset CC
    test -z "$C_COMPILER" || CC=$C_COMPILER
    has '^native: steps of euler, verlet, gauss8 are compiled; others are not$'
    test -e $work/at-work.met || fails "compiles one after the other"
    rm -rf $cache
fi
# Who ends a command that compiles finds nothing of it left.
cat >$work/compiler <<'END'
#!/bin/sh
echo >>"$SIGN"
while :; do
    sleep 1
done
END
chmod +x $work/compiler
SIGN=$PWD/$work/compiling
export SIGN
command='compare (TERM)'
CC=$PWD/$work/compiler "$nevh" compare pendulum $long --integrators gauss8,verlet \
    --dt 0.1 >$work/out 2>$work/err </dev/null &
compiling=$!
until test -e $SIGN; do
    kill -0 $compiling 2>/dev/null || { fails "does not compile"; break; }
    sleep 1
done
kill -s TERM $compiling
wait $compiling 2>/dev/null
test $? -gt 128 || fails "goes on after a signal"
# One that never ends is given up.
CC=$PWD/$work/compiler
export CC
exits 0 compare pendulum $long --integrators gauss8,verlet --dt 0.1
unset CC
says 'not compiled: the C compiler took too long'
has '^ *gauss8 '
test "$(ls -A $TMPDIR)" = '' || fails "leaves $(ls -A $TMPDIR)"
# Without a cache, too, it is asked once.
rm -f $SIGN
CC=$PWD/$work/compiler
export CC
exits 0 compare pendulum --t-end 20000 --integrators gauss8 --dt 0.1,0.05 --no-cache
unset CC
test "$(wc -l <$SIGN)" -eq 1 || fails "waits for $(wc -l <$SIGN) compilers"
rm -f $TMPDIR/*.late
unset SIGN
test "$(ls -A $TMPDIR)" = '' || fails "leaves $(ls -A $TMPDIR)"

exit $status

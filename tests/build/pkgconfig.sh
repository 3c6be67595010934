#!/bin/sh
# A user's way: make install, then compile with what pkg-config says.  The
# programs are those of the manual, so that what we print there works,
# and tests/build/outside.c, whose blocks become vector code without any flags.

srcdir=${srcdir:-.}
pkgconfig=${PKG_CONFIG:-pkg-config}
"$pkgconfig" --version >/dev/null 2>&1 ||
    { echo "there is no pkg-config"; exit 77; }

# Neither libtool's install nor lists of flags take spaces.
dest=$PWD/pkgconfig.$$
case $dest in
*' '*) dest=${TMPDIR:-/tmp}/nevh-pkgconfig.$$ ;;
esac
trap 'rm -rf "$dest"' EXIT
trap 'exit 1' HUP INT TERM
mkdir "$dest" || exit 1

fails() {
    echo "$1"
    exit 1
}

# Flags of the make that runs this test are not for the one below.
unset MAKEFLAGS MFLAGS MAKELEVEL
"${MAKE:-make}" install DESTDIR="$dest" >"$dest/log" 2>&1 ||
    { cat "$dest/log"; fails "make install failed"; }

pc=$(find "$dest" -name nevh.pc)
test -n "$pc" || fails "nevh.pc was not installed"
# DESTDIR is where the files are, though they are meant for elsewhere.
sed "s|^\([a-z_]*\)=/|\1=$dest/|" "$pc" >"$dest/nevh.pc"
PKG_CONFIG_PATH=$dest${PKG_CONFIG_PATH:+:$PKG_CONFIG_PATH}
export PKG_CONFIG_PATH

libdir=$("$pkgconfig" --variable=libdir nevh)
static=
test -e "$libdir/libnevh.so" || test -e "$libdir/libnevh.dylib" ||
    static=--static
flags=$("$pkgconfig" $static --cflags --libs nevh) || fails "pkg-config failed"
echo "flags: $flags"
LD_LIBRARY_PATH=$libdir${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}
DYLD_LIBRARY_PATH=$libdir
export LD_LIBRARY_PATH DYLD_LIBRARY_PATH
case " $flags" in
*" -lgsl"*) test -n "$static" ||
    fails "users of the shared library need not link GSL" ;;
esac

# What the manual shows of C: a program, and two ways to write a term.
# manual PATTERN: the first example with it in the manual, as it is printed.
manual() {
    awk -v pattern="$1" '
        /^@example/ { inside = 1; text = ""; next }
        inside && /^@end example/ {
            inside = 0
            if (text ~ pattern) { printf "%s", text; exit }
            next
        }
        inside { gsub(/@@/, "@"); gsub(/@\{/, "{"); gsub(/@\}/, "}"); text = text $0 "\n" }
        ' "$srcdir/doc/nevh.texi"
}
manual 'int main' >"$dest/manual.c"
{
    echo '#include <nevh/body.h>'
    echo '#include <nevh/nevh.h>'
    manual 'NEVH_BODY\(pendulum' | sed '/nevh_term/d'
    manual 'NEVH_GRADIENT\(pendulum'
    cat <<'END'
int main(void) {
    nevh_system *s = nevh_system_new(1);
    int status = nevh_system_add(s, &term);
    nevh_options exact = {.gradient = nevh_exact};
    nevh_stepper *step = nevh_stepper_new(s, nevh_verlet, &exact);
    double q = 2, p = 0;
    status += nevh_run(step, 0, 0.05, 100, &q, &p, NULL, 0);
    puts(status || !(q * q < 4.1) ? "fails: inf" : nevh_stepper_message(step));
    printf("%g %g\n", q, p);
    nevh_stepper_free(step);
    nevh_system_free(s);
    return status != 0;
}
END
} | sed '1i #include <stdio.h>' >"$dest/terms.c"
grep -q 'NEVH_GRADIENTS(pendulum)' "$dest/terms.c" || fails "the manual has no terms"
for program in manual terms; do
    test -s "$dest/$program.c" || fails "there is no C in $program"
    # Unquoted: compilers with options, and lists of flags.
    # shellcheck disable=SC2086
    ${CC:-cc} -std=c11 -o "$dest/$program" "$dest/$program.c" $SANITIZE_FLAGS $flags \
        -lm || fails "the C of $program does not compile"
    "$dest/$program" >"$dest/out" </dev/null ||
        { cat "$dest/out"; fails "the program of $program fails"; }
    test -s "$dest/out" || fails "the program of $program prints nothing"
    if grep -Eiw '[-+]?(nan|inf|infinity)' "$dest/out"; then
        fails "the program of $program prints a number that is not finite"
    fi
done

# builds_body COMPILER FLAGS...: and runs it.
builds_body() {
    # shellcheck disable=SC2086
    "$@" -Wall -Wextra -pedantic -Werror -o "$dest/outside" \
        "$srcdir/tests/build/outside.c" $flags ||
        fails "a user of <nevh/body.h> does not compile: $*"
    "$dest/outside" || fails "a user of <nevh/body.h> fails: $*"
}

# Whether the header says that it has vector functions.
has_vectors() {
    # shellcheck disable=SC2086
    printf '#include <nevh/body.h>\nvectors: NEVH__VECTORS\n' |
        "$@" -E - $flags 2>/dev/null | grep -q '^vectors: 1'
}

# The sanitizers of two compilers do not mix.
compilers="${CC:-cc}"
test -n "$SANITIZE_FLAGS" || for name in gcc clang; do
    test "$name" != "$CC" && command -v "$name" >/dev/null 2>&1 &&
        compilers="$compilers
$name"
done
tried=
while read -r compiler; do
    for flag in -std=c11 -std=gnu11 -std=gnu17 -DNEVH_PORTABLE -O0 -O3; do
        # shellcheck disable=SC2086
        builds_body $compiler -O2 $SANITIZE_FLAGS $flag
        # shellcheck disable=SC2086
        if has_vectors $compiler -O2 $SANITIZE_FLAGS $flag; then
            tried="$tried $compiler $flag;"
            for name in _ZGVbN2v_nevh_simd_sin _ZGVdN4v_nevh_simd_cos \
                _ZGVeN8v_nevh_simd_sin; do
                ${NM:-nm} "$dest/outside" | grep -q $name ||
                    fails "$compiler $flag: nothing calls $name"
            done
        fi
    done
done <<END
$compilers
END
echo "vector code:${tried:- none}"

cxx=
for name in $CXX c++ g++ clang++; do
    if command -v "$name" >/dev/null 2>&1; then
        cxx=$name
        break
    fi
done
test -n "$cxx" || { echo "no C++ compiler: the rest is well"; exit 0; }
cat >"$dest/user.cc" <<'END'
#include <nevh/nevh.h>
#include <nevh/body.h>
#include <nevh/gsl.h>
#include <nevh/extend.h>

NEVH_SIMD static void sines(size_t width, const double *q, double *h)
{
    NEVH_LANES(i, width) { h[i] = nevh_simd_sin(q[i]); }
}

NEVH_POINT static double sine(double x)
{
    return nevh_point_sin(x);
}

int main()
{
    double q[8] = {0}, h[8];
    nevh_term term = nevh_term();
    term.point_gradient = 0;
    sines(8, q, h);
    if (sine(1) < 0.8 || term.gradient)
        return 1;
    return nevh_status_text(NEVH_OK) == 0 || nevh_integrators()[0] == 0 ||
           h[7] != 0;
}
END
# The sanitizers of two compilers do not mix.
if test -z "$SANITIZE_FLAGS"; then
    # shellcheck disable=SC2086
    "$cxx" -o "$dest/user" "$dest/user.cc" $flags ||
        fails "the C++ program does not compile"
    "$dest/user" || fails "the C++ program fails"
fi
exit 0

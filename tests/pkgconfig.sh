#!/bin/sh
# A user's way: make install, then compile with what pkg-config says.  The
# program is the first one of README.md, so that what we print there works.

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

awk '/^```c *$/ { inside = 1; next } /^```/ && inside { exit } inside' \
    "$srcdir/README.md" >"$dest/readme.c" || fails "there is no README.md"
test -s "$dest/readme.c" || fails "README.md has no block of C"
# Unquoted: compilers with options, and lists of flags.
# shellcheck disable=SC2086
${CC:-cc} -std=c11 -o "$dest/readme" "$dest/readme.c" $SANITIZE_FLAGS $flags \
    -lm || fails "the program of README.md does not compile"
"$dest/readme" >"$dest/out" </dev/null ||
    { cat "$dest/out"; fails "the program of README.md fails"; }
test -s "$dest/out" || fails "the program of README.md prints nothing"
if grep -Eiw '[-+]?(nan|inf|infinity)' "$dest/out"; then
    fails "the program of README.md prints a number that is not finite"
fi

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
#include <nevh/gsl.h>
#include <nevh/extend.h>

int main()
{
    return nevh_status_text(NEVH_OK) == 0 || nevh_integrators()[0] == 0;
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

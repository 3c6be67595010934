#!/bin/sh
# What make install brings: a command that works wherever the tree is moved to,
# documents, examples that compile; and make uninstall leaves nothing of it.

srcdir=${srcdir:-.}
pkgconfig=${PKG_CONFIG:-pkg-config}
"$pkgconfig" --version >/dev/null 2>&1 ||
    { echo "there is no pkg-config"; exit 77; }

# Neither libtool's install nor lists of flags take spaces.
dest=$PWD/install.$$
case $dest in
*' '*) dest=${TMPDIR:-/tmp}/nevh-install.$$ ;;
esac
trap 'rm -rf "$dest" "$dest-moved"' EXIT
trap 'exit 1' HUP INT TERM
mkdir "$dest" || exit 1

fails() {
    echo "$1"
    exit 1
}

# Flags of the make that runs this test are not for the one below.
unset MAKEFLAGS MFLAGS MAKELEVEL NEVH_SCENES
"${MAKE:-make}" install DESTDIR="$dest" >"$dest/log" 2>&1 ||
    { cat "$dest/log"; fails "make install failed"; }

for file in README.md examples/energy_table.h examples/first_hamiltonian.c; do
    find "$dest" -path "*/share/doc/nevh/$file" | grep -q . ||
        fails "share/doc lacks $file"
done
for file in "$srcdir"/examples/*.[ch]; do
    find "$dest" -path "*/nevh/examples/$(basename "$file")" | grep -q . ||
        fails "the example $(basename "$file") is not installed"
done

# The tree moved as a whole: scenes, and cases of nevh hard, are found.
cp -R "$dest" "$dest-moved"
bin=$(find "$dest-moved" -path '*/bin/nevh')
lib=$(dirname "$(find "$dest-moved" -name nevh.pc)")/..
(
    LD_LIBRARY_PATH=$lib${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}
    export LD_LIBRARY_PATH
    mv "$dest" "$dest.away"
    "$bin" check pendulum --quiet >"$dest-moved/out" 2>&1
    status=$?
    mv "$dest.away" "$dest"
    exit $status
) || { cat "$dest-moved/out"; fails "a tree that was moved has no scenes"; }

# The line of the manual: compiled, it runs without LD_LIBRARY_PATH.
pc=$(find "$dest" -name nevh.pc)
sed "s|^\([a-z_]*\)=/|\1=$dest/|" "$pc" >"$dest/nevh.pc"
PKG_CONFIG_PATH=$dest${PKG_CONFIG_PATH:+:$PKG_CONFIG_PATH}
export PKG_CONFIG_PATH
grep -q 'Wl,-rpath,"$(pkg-config --variable=libdir nevh)"' "$srcdir/doc/nevh.texi" ||
    fails "the manual has another line for compilers"
libdir=$("$pkgconfig" --variable=libdir nevh)
static=
test -e "$libdir/libnevh.so" || static=--static
flags=$("$pkgconfig" $static --cflags --libs nevh)
examples=$(dirname "$(find "$dest" -name energy_table.h)")
for sources in first_hamiltonian.c 'pendulum_energy.c energy_table.c' effects.c; do
    list=
    for one in $sources; do list="$list $examples/$one"; done
    # Unquoted: compilers with options, and lists.
    # shellcheck disable=SC2086
    ${CC:-cc} -std=c11 -o "$dest/example" $list $SANITIZE_FLAGS $flags \
        -Wl,-rpath,"$libdir" -lm || fails "$sources does not compile"
    (unset LD_LIBRARY_PATH; "$dest/example" >"$dest/out" </dev/null) ||
        { cat "$dest/out"; fails "$sources fails"; }
    test -s "$dest/out" || fails "$sources prints nothing"
done

# All of them by their own Makefile.
cp -R "$examples" "$dest-moved/examples"
if "${MAKE:-make}" --version 2>/dev/null | grep -q GNU && test -z "$static$SANITIZE_FLAGS"; then
    "${MAKE:-make}" -C "$dest-moved/examples" CC="${CC:-cc}" CFLAGS= \
        >"$dest-moved/log" 2>&1 ||
        { cat "$dest-moved/log"; fails "the Makefile of the examples fails"; }
    test -x "$dest-moved/examples/gradient_cost" || fails "make leaves an example out"
fi

# Nothing of nevh stays: no file, no folder of its own.  The prefix itself may
# have nevh in its name.
prefix=$(dirname "$(dirname "$(find "$dest" -path '*/bin/nevh')")")
rm -f "$dest/nevh.pc" "$dest/example" "$dest/out" "$dest/log"
"${MAKE:-make}" uninstall DESTDIR="$dest" >"$dest-moved/log" 2>&1 ||
    { cat "$dest-moved/log"; fails "make uninstall failed"; }
left=$(find "$dest" ! -type d ! -path '*/info/dir'; cd "$prefix" && find . -name '*nevh*')
test -z "$left" || { echo "$left"; fails "make uninstall leaves these"; }
exit 0

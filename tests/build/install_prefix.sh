#!/bin/sh
# A build that was installed in one prefix and is then installed in another has a
# command that starts, with the library of the prefix where it stands.

here=$(pwd -P)
case $here in
*' '*) echo "libtool takes no spaces in $here"; exit 77 ;;
esac

# A copy of the build beside it, so that relative paths to the sources stay right.
copy=$(dirname "$here")/nevh-build.$$
trap 'rm -rf "$copy"' EXIT
trap 'exit 1' HUP INT TERM
mkdir "$copy" 2>/dev/null || { echo "no folder can be made beside $here"; exit 77; }

fails() {
    echo "$1"
    tail -n 40 "$copy/log"
    exit 1
}

for entry in * .libs; do
    case $entry in
    tests | examples | nevh-build.* | *.log) ;;
    *) cp -pR "$entry" "$copy/" || fails "$entry cannot be copied" ;;
    esac
done

# Flags of the make that runs this test are not for the ones below.
unset MAKEFLAGS MFLAGS MAKELEVEL NEVH_SCENES LD_LIBRARY_PATH
install_in() {
    "${MAKE:-make}" -C "$copy" prefix="$copy/$1" install-exec >"$copy/log" 2>&1 ||
        fails "make install fails in prefix $1"
    grep -q 'has not been installed' "$copy/log" &&
        fails "libtool links with a library that is not in prefix $1"
    "$copy/$1/bin/nevh" --version >"$copy/version" 2>&1 ||
        { cat "$copy/version"; fails "the command in prefix $1 does not start"; }
}
install_in one
install_in two

# With the first prefix gone, a command that looked there would not start.
rm -rf "$copy/one"
"$copy/two/bin/nevh" --version >"$copy/version" 2>&1 ||
    { cat "$copy/version"; fails "the second command needs the first prefix"; }
exit 0

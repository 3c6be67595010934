#!/bin/sh
# debian/ is of this version, and each file that make install brings belongs to
# a package of it.

srcdir=${srcdir:-.}
test -d "$srcdir/debian" || { echo "tarballs have no debian/"; exit 77; }
dpkg-parsechangelog --version >/dev/null 2>&1 ||
    { echo "there is no dpkg-parsechangelog"; exit 77; }
debian=$(CDPATH='' cd "$srcdir/debian" && pwd)

# Neither libtool's install nor lists of patterns take spaces.
dest=$PWD/debian.$$
case $dest in
*' '*) dest=${TMPDIR:-/tmp}/nevh-debian.$$ ;;
esac
trap 'rm -rf "$dest"' EXIT
trap 'exit 1' HUP INT TERM
mkdir "$dest" || exit 1
status=0

wrong() {
    echo "$1"
    status=1
}

version=$(sed -n 's/^#define PACKAGE_VERSION "\(.*\)"/\1/p' config.h)
packaged=$(dpkg-parsechangelog -l "$debian/changelog" -S Version)
test "${packaged%-*}" = "$version" ||
    wrong "debian/changelog is of $packaged, configure.ac of $version"
news=$(sed -n 's/^Version \([^ ]*\).*/\1/p' "$srcdir/NEWS" | head -n 1)
test "$news" = "$version" || wrong "NEWS begins with $news, configure.ac has $version"
case $(dpkg-parsechangelog -l "$debian/changelog" -S Distribution) in
UNRELEASED) released=no ;;
*) released=yes ;;
esac
if grep -q "^Version $version (not released)" "$srcdir/NEWS"; then
    test $released = no || wrong "debian/changelog says released, NEWS says not"
else
    test $released = yes || wrong "debian/changelog says UNRELEASED, NEWS does not"
fi

# The library's package is named by what programs are linked to.
soname=$(sed -n "s/^dlname='libnevh\.so\.\(.*\)'/\1/p" libnevh.la)
test -z "$soname" || grep -q "^Package: libnevh$soname\$" "$debian/control" ||
    wrong "debian/control has no package libnevh$soname"
for list in "$debian"/*.install; do
    name=$(basename "$list" .install)
    grep -q "^Package: $name\$" "$debian/control" ||
        wrong "debian/control has no package $name"
done

# unpacked FILES PATTERNS: those files that no pattern, of a file or of a folder,
# takes.
unpacked() {
    while IFS= read -r file; do
        while IFS= read -r pattern; do
            # A pattern is meant.
            # shellcheck disable=SC2254
            case $file in
            $pattern | $pattern/*) continue 2 ;;
            esac
        done <"$2"
        echo "$file"
    done <"$1"
}
printf 'usr/bin/nevh\nusr/share/a/b\nusr/lib/any/libnevh.so\n' >"$dest/files"
printf 'usr/share/a\nusr/lib/*/libnevh.so\n' >"$dest/patterns"
test "$(unpacked "$dest/files" "$dest/patterns")" = usr/bin/nevh ||
    { echo "a file without a package was not found"; exit 1; }

# Flags of the make that runs this test are not for the one below.
unset MAKEFLAGS MFLAGS MAKELEVEL
"${MAKE:-make}" install DESTDIR="$dest/root" >"$dest/log" 2>&1 ||
    { cat "$dest/log"; exit 1; }
bin=$(find "$dest/root" -path '*/bin/nevh')
# As with Debian's prefix and folder of libraries; what rules removes, and
# nevh-mpi, which is not configured there.
(cd "$(dirname "$(dirname "$bin")")" && find . ! -type d) |
    sed 's,^\./,usr/,; s,^usr/lib/,usr/lib/any/,' |
    grep -Ev '/info/dir$|\.la$|/nevh-mpi$' >"$dest/files"
sed 's/ .*//; /^debian\//d' "$debian"/*.install >"$dest/patterns"
left=$(unpacked "$dest/files" "$dest/patterns")
test -z "$left" || wrong "no package has
$left"
exit $status

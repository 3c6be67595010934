#!/bin/sh
# stage.sh FOLDER: nevh as a folder that runs wherever it is moved to: FOLDER/bin/nevh,
# FOLDER/lib with all libraries but those of glibc, FOLDER/share/nevh/scenes.  Called
# by make, which sets CC, LDFLAGS, OBJECTS, GSL_LIBS, LIBS, STRIP and srcdir.
# SPDX-License-Identifier: GPL-3.0-or-later

set -e
folder=$1
rm -rf "$folder" "$folder.new"
mkdir -p "$folder.new/lib" "$folder.new/bin" "$folder.new/share/nevh/scenes/hard"

# An rpath, not a runpath: libraries that GSL needs are looked for there, too.
$CC -pthread -shared -o "$folder.new/lib/libnevh.so.0" -Wl,-soname,libnevh.so.0 $LDFLAGS \
    -Wl,--disable-new-dtags,-rpath,'$ORIGIN' -Wl,--whole-archive \
    .libs/libnevh_core.a -Wl,--no-whole-archive $GSL_LIBS $LIBS
$CC -pthread -o "$folder.new/bin/nevh" $LDFLAGS -Wl,--disable-new-dtags \
    -Wl,-rpath,'$ORIGIN/../lib' $OBJECTS "$folder.new/lib/libnevh.so.0" \
    $GSL_LIBS $LIBS

# The licence of each copied library lets it be handed on with its source, which
# the system it is of has.
ldd "$folder.new/lib/libnevh.so.0" "$folder.new/bin/nevh" |
    awk '$2 == "=>" && $3 ~ /^\// { print $3 }' | sort -u |
    while read -r library; do
        case $(basename "$library") in
        libc.so* | libm.so* | libdl.so* | libpthread.so* | librt.so*) ;;
        ld-linux* | libnevh.so*) ;;
        *) cp -L "$library" "$folder.new/lib/" ;;
        esac
    done
${STRIP:-strip} -S "$folder.new"/lib/*.so* "$folder.new/bin/nevh" 2>/dev/null || :
chmod 644 "$folder.new"/lib/*
cp "$srcdir"/scenes/*.nevh "$srcdir"/scenes/*.csv "$folder.new/share/nevh/scenes/"
mkdir -p "$folder.new/share/nevh/sheets"
cp "$srcdir"/doc/sheets/sheets.texi "$srcdir"/doc/sheets/sheets.css "$srcdir"/doc/sheets/*.list "$srcdir"/doc/sheets/check.js \
    "$srcdir"/doc/sheets/*.nevh "$folder.new/share/nevh/sheets/"
cp "$srcdir"/scenes/hard/*.nevh "$folder.new/share/nevh/scenes/hard/"
# The kit of nevh page, where it was made.
for kit in web/kit.html "$srcdir/web/kit.html"; do
    test ! -f "$kit" || cp "$kit" "$folder.new/share/nevh/page.html"
done
mv "$folder.new" "$folder"

#!/bin/sh
# site.sh SRCDIR NEVH FOLDER: the manual as pages in FOLDER, each picture below the
# command that draws it, with a gallery of the pictures, the worksheets and a search
# that needs no server.  MAKEINFO and MAKEINFOFLAGS are those of make.

srcdir=$(cd "$1" && pwd) nevh=$(cd "$(dirname "$2")" && pwd)/$(basename "$2")
mkdir -p "$3" && to=$(cd "$3" && pwd) || exit 1
NEVH_SCENES=$srcdir/scenes
export NEVH_SCENES
pages=$srcdir/doc/site
work=${TMPDIR:-/tmp}/site.$$
trap 'rm -rf $work' EXIT
trap 'exit 1' HUP INT TERM
mkdir "$work" || exit 1

page() { # TITLE, which is read from stdin: a page of the site's own
    cat <<END
<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>$1</title>
$(cat "$pages/head.html")
</head><body>
$(cat "$pages/top.html")
<h1>$1</h1>
$(cat)
</body></html>
END
}
manual() { # OPTION... FILE
    ${MAKEINFO:-makeinfo} $MAKEINFOFLAGS --html --css-ref=site.css \
        -c "EXTRA_HEAD=$(cat "$pages/head.html")" \
        -c "AFTER_BODY_OPEN=$(cat "$pages/top.html")" "$@"
}

manual --split=chapter -o "$work/pages" "$srcdir/doc/nevh.texi" &&
    manual --no-split -I "$srcdir/doc/sheets" -o "$work/pages/sheets.html" \
        "$srcdir/doc/sheets/sheets.texi" || exit 1
cp "$pages/site.css" "$pages/search.js" "$work/pages"
mkdir "$work/pages/pictures" "$work/run"
cp "$srcdir/doc/hoop.nevh" "$srcdir"/scenes/*.csv "$work/run"

# Each command of the manual and of the commands' help that draws an SVG file.
{
    "$nevh" help --format json |
        sed -n 's/^.*"\(nevh [^"]*\.svg[^"]*\)".*$/\1/p'
    cat "$work"/pages/[A-Z]*.html
} | awk -v mode=commands -f "$pages/pictures.awk" >"$work/list"
awk '!seen[$0]++' "$work/list" >"$work/commands"
number=0
while read -r command; do
    number=$((number + 1))
    file=$(echo "$command" | sed 's/.* \([a-z0-9-]*\.svg\).*/\1/')
    (cd "$work/run" && nevh() { "$nevh" "$@"; } && eval "$command") \
        >"$work/out" 2>&1 </dev/null && test -s "$work/run/$file" ||
        { cat "$work/out"; echo "does not draw: $command"; exit 1; }
    mv "$work/run/$file" "$work/pages/pictures/$number.svg"
    printf '%s\t%s\n' "pictures/$number.svg" "$command" >>"$work/drawn"
done <"$work/commands" || exit 1

awk -v mode=gallery -f "$pages/pictures.awk" "$work/drawn" |
    page Gallery >"$work/pages/gallery.html"
for file in "$work"/pages/[A-Z]*.html; do
    awk -v mode=insert -v drawn="$work/drawn" -f "$pages/pictures.awk" "$file" \
        >"$work/page" && mv "$work/page" "$file" || exit 1
done
awk -f "$pages/search.awk" "$work"/pages/*.html >"$work/pages/search-index.js"
rm -rf "$to" && mv "$work/pages" "$to"

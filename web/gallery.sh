#!/bin/sh
# Live pages of scenes, with an index:
#
#   gallery.sh NEVH FOLDER SCENE...
nevh=$1
folder=$2
shift 2
mkdir -p "$folder" || exit 1

# Text between tags.
escaped() {
    sed 's/&/\&amp;/g; s/</\&lt;/g; s/>/\&gt;/g'
}

index=$folder/index.html
{
    cat <<'HEAD'
<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>nevh: live pages</title>
<style>
:root{color-scheme:light dark}
body{font:16px/1.5 system-ui,sans-serif;max-width:46rem;margin:auto;padding:1rem}
li{margin:.4rem 0}
</style>
</head>
<body>
<main>
<h1>Hamiltonians that move</h1>
<p>Each page computes in your browser, and needs no network.</p>
<ul>
HEAD
    for scene in "$@"; do
        name=$(basename "$scene" .nevh)
        "$nevh" page "$scene" -o "$folder/$name.html" || exit 1
        title=$(sed -n 's/^title *= *//p' "$scene" | head -n 1 | escaped)
        printf '<li><a href="%s.html">%s</a></li>\n' "$name" "${title:-$name}"
    done
    printf '</ul>\n</main>\n</body>\n</html>\n'
} >"$index.new" || exit 1
mv "$index.new" "$index"
echo "$index"

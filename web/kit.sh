#!/bin/sh
# The live page without its scene, from its parts:
#
#   kit.sh FOLDER MODULE >FILE
#
# A line "@SCENE@" is where nevh page puts the scene.
folder=$1
module=$2

# An element that holds a compressed file: its length, then two letters for 13 bits, the
# lowest first: letters from # to ~ without <, as 91^2 > 2^13.
packed() { # ID
    printf '<script type="text/plain" id="%s">' "$1"
    od -An -v -tu1 | LC_ALL=C awk '
        BEGIN { for (i = 0; i < 91; i++) letter[i] = sprintf("%c", i + 35 + (i > 24))
                unit = 1 }
        function put(  low) {
            low = bits % 8192
            all = all letter[low % 91] letter[int(low / 91)]
            bits = int(bits / 8192); unit /= 8192
            if (length(all) > 2000) { out[n++] = all; all = "" } }
        { for (i = 1; i <= NF; i++) {
              bits += $i * unit; unit *= 256; count++
              if (unit >= 8192) put() } }
        END { if (unit > 1) put()
              printf "%d ", count
              for (i = 0; i < n; i++) printf "%s", out[i]
              printf "%s</script>\n", all }'
}

cat <<'HEAD'
<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>nevh</title>
</head>
<body>
<noscript><p>This page needs JavaScript, which runs the scene. The page of nevh report does not.</p></noscript>
<main hidden>
HEAD
cat "$folder/page.html" || exit 1
printf '</main>\n<script type="application/json" id="given">\n@SCENE@\n</script>\n'
# put ID FILE: smaller by 5 %, where zopfli is.
put() {
    zopfli -c "$2" 2>/dev/null >"$module.gz" ||
        gzip -9 -n -c "$2" >"$module.gz" || exit 1
    packed "$1" <"$module.gz" || exit 1
}
put module "$module"
# Without comments, and spaces before lines.
short() {
    sed 's/^ *//; /^\/\//d' "$@"
}
short "$folder/engine.js" >"$module.text" && put engine "$module.text"
# The style comes with the scripts, so that the page is not seen without it.
scripts() {
    printf 'document.head.append(document.createElement("style"));\n'
    printf 'document.head.lastChild.textContent = `'
    cat "$folder/page.css" || exit 1
    printf '`;\ndocument.querySelector("main").hidden = false;\n'
    awk -f "$folder/looks.awk" "$folder/../tools/plot/looks.h"
    short "$folder/view.js" "$folder/page.js" "$folder/draw.js" \
        "$folder/section.js" "$folder/try.js" "$folder/controls.js"
}
scripts >"$module.text" && put scripts "$module.text"
printf '<script>\n'
cat "$folder/unpack.js" || exit 1
printf '</script>\n</body>\n</html>\n'

#!/bin/sh
# The live page without its scene, from its parts:
#
#   kit.sh FOLDER MODULE >FILE
#
# A line "@SCENE@" is where nevh page puts the scene.
folder=$1
module=$2
cat <<'HEAD'
<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>nevh</title>
<style>
HEAD
cat "$folder/page.css" || exit 1
printf '</style>\n</head>\n<body>\n<main>\n'
cat "$folder/page.html" || exit 1
printf '</main>\n<script type="application/json" id="given">\n@SCENE@\n</script>\n'
printf '<script type="text/plain" id="module">\n'
gzip -9 -n <"$module" | base64 -w 0 || exit 1
printf '\n</script>\n<script type="text/plain" id="engine">\n'
cat "$folder/engine.js" || exit 1
printf '</script>\n'
for script in view page controls; do
    printf '<script>\n'
    cat "$folder/$script.js" || exit 1
    printf '</script>\n'
done
printf '</body>\n</html>\n'

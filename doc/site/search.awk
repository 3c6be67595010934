# The text of pages as a script: site.entries = [[page, title, text], ...], an entry a
# section.
# SPDX-License-Identifier: GPL-3.0-or-later

function plain(text) {
    gsub(/<[^>]*>/, "", text)
    gsub(/&nbsp;/, " ", text)
    gsub(/[ \t]+/, " ", text)
    gsub(/\\/, "\\\\", text)
    gsub(/"/, "\\\"", text)
    return text
}
function put() {
    if (title != "")
        printf "[\"%s\",\"%s\",\"%s\"],\n", file anchor, title, text
    text = ""
}

BEGIN { print "const siteEntries = [" }
FNR == 1 {
    put()
    title = ""
    file = FILENAME
    sub(/.*\//, "", file)
    anchor = ""
    inside = 0
}
/<body/ { inside = 1 }
!inside { next }
/<nav class="top"/ { skip = 1 }
/<div class="header"/ { skip = 1 }
/<(div|span|dt)[^>]* id=["'][^"']*/ {
    id = $0
    sub(/.* id=["']/, "", id)
    sub(/["'].*/, "", id)
}
/<h[1-4]/ {
    put()
    title = plain($0)
    anchor = id ? "#" id : ""
}
!skip && !/<h[1-4]/ { text = text " " plain($0) }
/<\/nav>/ { skip = 0 }
/<\/div>/ { skip = 0 }
END {
    put()
    print "];"
}

# Pictures of the manual's pages.
# mode=commands  the commands that draw an SVG file, a line each
# mode=insert    the page, with the picture below the block that has its command;
#                drawn: a file of lines PICTURE, tab, COMMAND
# mode=gallery   the pictures of such a file, with their commands
# SPDX-License-Identifier: GPL-3.0-or-later

function plain(text) {
    gsub(/<[^>]*>/, "", text)
    gsub(/&lsquo;|&rsquo;|&quot;/, "'", text)
    gsub(/&lt;/, "<", text)
    gsub(/&gt;/, ">", text)
    gsub(/&amp;/, "\\&", text)
    return text
}
function html(text) {
    gsub(/&/, "\\&amp;", text)
    gsub(/</, "\\&lt;", text)
    return text
}
# The command of a line, or "".  A quotation mark after it is the text's.
function command(text) {
    if (text !~ /nevh [a-z]+ .*--(plot|picture) [a-z0-9-]+\.svg/)
        return ""
    match(text, /nevh [a-z]+ /)
    text = substr(text, RSTART)
    if (text ~ /\.svg'/)
        sub(/\.svg'.*/, ".svg", text)
    return text
}
function figure(picture, text) {
    return "<figure><a href=\"" picture "\"><img src=\"" picture "\" alt=\"Picture of " \
        html(text) "\" loading=\"lazy\"></a>"
}

BEGIN {
    while (drawn && (getline line < drawn) > 0) {
        split(line, part, "\t")
        picture[part[2]] = part[1]
    }
}
mode == "gallery" {
    split($0, part, "\t")
    print figure(part[1], part[2]) "\n<figcaption><pre>" html(part[2]) \
        "</pre></figcaption></figure>"
    next
}
{
    line = plain($0)
    whole = joined line
    joined = ""
    if (line ~ /\\$/) {
        joined = substr(whole, 1, length(whole) - 1)
        gsub(/ +$/, "", joined)
        joined = joined " "
        sub(/^ +/, "", joined)
    } else {
        gsub(/  +/, " ", whole)
        found = command(whole)
        if (found && mode == "commands")
            print found
        if (found in picture)
            below = below figure(picture[found], found) "</figure>\n"
    }
    if (mode == "insert") {
        print
        if (below && /<\/pre><\/div>|<\/p>/) {
            printf "%s", below
            below = ""
        }
    }
}

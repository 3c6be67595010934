# nevh: the C reference out of the docstrings of the public headers.
# SPDX-License-Identifier: GPL-3.0-or-later
#
#     awk -f reference.awk -v form=texi|man HEADER... >OUTPUT
#
# Each header becomes a section.  Its first comment introduces the section; a
# comment that stands alone is a paragraph; any other comment describes the
# declarations that follow it, up to an empty line.  In a comment, a line such
# as "returns   what it returns" is an item, and text indented without an item
# above it is an example.  Names with two underscores are private.  In headers
# with code, a comment without a public name is about the code.

FNR == 1 {
    flush_group()
    head = 1
    depth = 0
    code = FILENAME ~ /\/(body|simd)\.h$/
    name = FILENAME
    sub(/.*include\//, "", name)
    section("<" name ">")
}

in_comment { comment_line($0); next }

/^\/\// { next }

/^\/\*/ && declaration == "" {
    flush_group()
    n_doc = 0
    in_comment = 1
    comment_line($0)
    next
}

# A macro that a comment describes, else a line for the preprocessor.
declaration == "" && (/^#/ || continued) {
    if (!continued && n_doc && /^#define (NEVH|nevh)_[A-Za-z0-9]/) {
        macro = $0
        sub(/^#define /, "", macro)
        sub(/ *\\$/, "", macro)
        if (match(macro, /^[A-Za-z0-9_]*\([^)]*\)/))
            macro = substr(macro, 1, RLENGTH)
        else
            sub(/ .*/, "", macro)
        add_declaration("Macro", macro, "")
    } else if (continued && match($0, /X\(NEVH_[A-Z]+, [0-9]+, ".*"\)/)) {
        entry = substr($0, RSTART + 2, RLENGTH - 3)
        split(entry, part, ", ")
        text = entry
        sub(/^[^"]*"/, "", text)
        sub(/"$/, "", text)
        notes[++n_notes] = part[1] " (" part[2] "): " text
    }
    continued = /\\$/
    next
}

declaration == "" && (/^$/ || /^extern "C"/ || /^}$/) { flush_group(); next }

declaration == "" && /^(NEVH__|static )/ { skipping = 1 }

{
    line = $0
    opened = gsub(/{/, "{", line)
    closed = gsub(/}/, "}", line)
    depth += opened - closed
    declaration = declaration (declaration == "" ? "" : "\n") $0
    if (depth != 0 || $0 !~ /;|}$/)
        next
    if ($0 ~ /\/\*/ && $0 !~ /\*\// || unfinished && $0 !~ /\*\//) {
        unfinished = 1
        next
    }
    unfinished = 0
    if ($0 !~ /;/ && !skipping)
        next
    declared(declaration)
    declaration = ""
    skipping = 0
}

END { flush_group() }

function comment_line(line) {
    if (line ~ /\*\//) {
        in_comment = 0
        sub(/ *\*\/.*$/, "", line)
    }
    sub(/^\/\* ?/, "", line)
    sub(/^   /, "", line)
    if (line !~ /SPDX-License-Identifier/)
        doc[++n_doc] = line
    if (!in_comment && head) {
        sub(/^nevh: */, "", doc[1])
        doc[1] = toupper(substr(doc[1], 1, 1)) substr(doc[1], 2)
        paragraphs(doc, n_doc)
        n_doc = 0
        head = 0
    }
}

# One declaration, perhaps with a comment behind it.
function declared(text, comment, at, kind) {
    if (text ~ /^(typedef )?(struct|enum|union) [a-z_]*nevh__/ ||
        text ~ /nevh__[a-z_]*(;|\()/ || text ~ /^NEVH__/ || skipping)
        return
    comment = ""
    at = index(text, ";")
    if (text ~ /^(typedef|struct|enum)/ && text ~ /{/) {
        for (at = length(text); substr(text, at, 1) != ";"; at--)
            ;
        if (substr(text, at) ~ /\*\//) # the semicolon is inside a comment
            for (at = index(text, "\n}"); substr(text, at, 1) != ";"; at++)
                ;
    }
    if (substr(text, at + 1) ~ /\/\*/) {
        comment = substr(text, at + 1)
        gsub(/[ \n]+/, " ", comment)
        gsub(/^ *\/\* *| *\*\/ *$/, "", comment)
    }
    text = substr(text, 1, at - 1)
    if (text ~ /^(typedef|struct|enum)/)
        kind = "Type"
    else if (text ~ /^NEVH_API extern/)
        kind = "Constant"
    else if (text ~ /^NEVH_API/)
        kind = "Function"
    else
        return
    sub(/^NEVH_API (extern )?/, "", text)
    sub(/\n#if.*$/, "", text) # attributes
    add_declaration(kind, text, comment)
}

function add_declaration(kind, text, comment) {
    if (n_group && kind != kinds[n_group])
        flush_group()
    kinds[++n_group] = kind
    group[n_group] = text
    if (comment != "")
        notes[++n_notes] = name_of(text) ": " comment
}

# The name that a declaration declares.
function name_of(text) {
    gsub(/\n/, " ", text)
    if (match(text, /\(\*nevh_[a-z0-9_]*\)/))
        return substr(text, RSTART + 2, RLENGTH - 3)
    if (text ~ /^typedef.*}/) {
        sub(/^.*} */, "", text)
        return text
    }
    if (match(text, /nevh_[a-z0-9_]* *\(/)) {
        text = substr(text, RSTART, RLENGTH - 1)
        return text
    }
    if (text ~ /^(struct|enum) .*{/) {
        sub(/ *{.*/, "", text)
        return text
    }
    sub(/^.*[ *]/, "", text)
    return text
}

function flush_group(i) {
    if (n_group) {
        for (i = 1; i <= n_group; i++)
            declaration_out(kinds[i], group[i], i)
        description_begin()
        if (n_doc)
            paragraphs(doc, n_doc)
        for (i = 1; i <= n_notes; i++)
            paragraph(notes[i])
        description_end()
    } else if (n_doc && (!code || public(doc, n_doc)))
        paragraphs(doc, n_doc)
    n_group = n_doc = n_notes = 0
}

# Beside code, comments speak of the code unless they name what is public.
function public(lines, n, i) {
    for (i = 1; i <= n; i++)
        if (lines[i] ~ /(NEVH|nevh)_[A-Za-z]/)
            return 1
    return 0
}

# Lines of a comment: paragraphs, items, examples.
function paragraphs(lines, n, i, line, text, state) {
    state = text = ""
    for (i = 1; i <= n + 1; i++) {
        line = i <= n ? lines[i] : ""
        if (line == "" && state == "example" && i <= n &&
            lines[i + 1] ~ /^ /) {
            example_line("")
            continue
        }
        if (line ~ /^[a-z_][A-Za-z_0-9]*(, [a-z_]+)*   *[^ ]/ &&
            line !~ /^[^ ]+ [^ ]/ ||
            line ~ /^[a-z_]+(, [a-z_]+)+   *[^ ]/) {
            state = close_text(state, text)
            if (!listing)
                list_begin()
            listing = 1
            match(line, /   */)
            item(substr(line, 1, RSTART - 1))
            text = substr(line, RSTART + RLENGTH)
            state = "item"
        } else if (line == "") {
            state = close_text(state, text)
            text = ""
        } else if (line ~ /^ / && (state == "item" || listing)) {
            sub(/^ */, "", line)
            text = text (text == "" ? "" : "\n") line
            state = "item"
        } else if (line ~ /^  /) {
            if (state != "example") {
                state = close_text(state, text)
                text = ""
                example_begin()
            }
            state = "example"
            example_line(line)
        } else {
            if (state != "paragraph") {
                state = close_text(state, text)
                text = ""
                if (listing)
                    list_end()
                listing = 0
            }
            text = text (text == "" ? "" : "\n") line
            state = "paragraph"
        }
    }
    close_text(state, text)
    if (listing)
        list_end()
    listing = 0
}

function close_text(state, text) {
    if (state == "example")
        example_end()
    else if (state == "item")
        print escape(text)
    else if (text != "")
        paragraph(text)
    return ""
}

# The two forms.

function escape(text) {
    if (form == "texi")
        gsub(/[@{}]/, "@&", text)
    else {
        gsub(/\\/, "\\e", text)
        gsub(/-/, "\\-", text)
        gsub(/\n\./, "\n\\\\\\&.", text)
        gsub(/\n'/, "\n\\\\\\&'", text)
        if (text ~ /^[.']/)
            text = "\\&" text
    }
    return text
}

function section(title) {
    if (form == "texi")
        printf "\n@section @code{%s}\n", title
    else
        printf ".SH \"%s\"\n", escape(title)
}

function paragraph(text) {
    if (form == "texi")
        print "\n" escape(text)
    else
        print ".PP\n" escape(text)
}

function declaration_out(kind, text, i, name, flat) {
    name = name_of(text)
    if (form == "man") {
        print i == 1 ? ".PP\n.nf" : ".nf"
        flat = escape(text)
        gsub(/\n/, "\n.B \"", flat)
        gsub(/"/, "\\(dq", flat)
        gsub(/\n\.B \\\(dq/, "\n.B \"", flat)
        gsub(/\n/, "\"\n", flat)
        print ".B \"" flat "\"\n.fi"
        return
    }
    if (kind == "Function") {
        flat = text
        gsub(/[ \n]+/, " ", flat)
        match(flat, name " *\\(")
        printf "@deftypefn%s %s {%s} %s %s\n", i == 1 ? "" : "x", kind,
            escape(trim(substr(flat, 1, RSTART - 1))), name,
            escape(substr(flat, RSTART + length(name)))
        defined = "deftypefn"
    } else if (kind == "Constant") {
        flat = text
        gsub(/[ \n]+/, " ", flat)
        sub(/[^ *]*$/, "", flat)
        printf "@deftypevr%s %s {%s} %s\n", i == 1 ? "" : "x", kind,
            escape(trim(flat)), name
        defined = "deftypevr"
    } else {
        printf "@deftp%s %s {%s}\n", i == 1 ? "" : "x", kind,
            escape(kind == "Macro" ? text : name)
        defined = "deftp"
    }
}

function trim(text) {
    gsub(/^ +| +$/, "", text)
    return text
}

function description_begin(i) {
    if (form == "man") {
        print ".RS 4"
        return
    }
    for (i = 1; i <= n_group; i++)
        if (kinds[i] == "Type")
            print "@example\n" escape(group[i]) ";\n@end example"
}

function description_end() {
    print form == "texi" ? "@end " defined "\n" : ".RE"
}

function list_begin() {
    print form == "texi" ? "@table @asis" : ".RS 0"
}

function list_end() {
    print form == "texi" ? "@end table" : ".RE"
}

function item(label) {
    if (form == "texi")
        print "@item " escape(label)
    else
        print ".TP 10\n" escape(label)
}

function example_begin() {
    print form == "texi" ? "\n@example" : ".PP\n.nf"
}

function example_line(line) {
    sub(/^ ? ? ? ?/, "", line)
    print escape(line)
}

function example_end() {
    print form == "texi" ? "@end example" : ".fi"
}

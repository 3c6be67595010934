# Headers as arrays of strings, nevh__NAME_text, a line each, ended by NULL.  What
# stands before the guard, the guard and what is included are left out; conditions
# inside remain.
FNR == 1 {
    if (NR > 1)
        print "    0};"
    else
        print "#include \"native/writer_private.h\""
    name = FILENAME
    sub(/.*\//, "", name)
    sub(/(_private)?\.h$/, "", name)
    print "const char *const nevh__" name "_text[] = {"
    guard = ""
    depth = 0
}
/^#ifndef/ && guard == "" { guard = $2; next }
guard == "" || /^#include/ || $0 == "#define " guard { next }
/^#if/ { depth++ }
/^#endif/ && depth-- == 0 { next }
{
    gsub(/\\/, "&&")
    gsub(/"/, "\\\"")
    print "    \"" $0 "\\n\","
}
END { print "    0};" }

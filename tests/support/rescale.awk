# A scene in other units: awk -v L=2 -v E=1 -v T=1 -f rescale.awk SCENE multiplies
# lengths (all coordinates) by L, effects by E, times by T and momenta by E*T/L, and
# leaves out what no orbit depends on.  With -v few=100 a run has that many, of the
# first dt, and any integrators.

BEGIN {
    P = E*T/L
    units = sprintf("u_L = %.17g\nu_E = %.17g\nu_T = %.17g\nu_P = %.17g\n", L, E, T, P)
    if (ARGC > 1)
        ARGV[ARGC++] = ARGV[1]       # coordinates have to be known first
}

function trim(s) { gsub(/^[ \t]+|[ \t]+$/, "", s); return s }

# The length of the name, number or sign at the start of s.
function token(s) {
    if (match(s, /^[0-9]+\.\./))
        return RLENGTH - 2
    if (match(s, /^([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?/) ||
        match(s, /^[A-Za-z_][A-Za-z0-9_]*/))
        return RLENGTH
    return 1
}

# A name with its subscript, which may have subscripts inside.
function element(s,    n, depth, c) {
    n = token(s)
    if (substr(s, n + 1, 1) != "[")
        return n
    do {
        n++
        c = substr(s, n, 1)
        depth += (c == "[") - (c == "]")
    } while (depth)
    return n
}

# A formula whose variables have units; with `times`, each outermost summand is
# multiplied by it, as nevh takes effects apart there.
function formula(s, times,    out, name, word, n, depth, operand) {
    while (s != "") {
        name = substr(s, 1, token(s))
        n = length(name)
        word = name
        if (name in coordinate || name ~ /^[pv]_/ && substr(name, 3) in coordinate) {
            n = element(s)
            word = "(" substr(s, 1, n) \
                (name in coordinate ? "/u_L)" : name ~ /^p_/ ? "/u_P)" : "*u_T/u_L)")
        } else if (name == "t")
            word = "(t/u_T)"
        else if (times && !depth && operand && name ~ /^[-+]$/)
            word = "*" times " " name
        depth += (name ~ /^[(\[]$/) - (name ~ /^[)\]]$/)
        if (name !~ /^[ \t]$/)
            operand = name ~ /^[A-Za-z0-9_.)\]]/
        out = out word
        s = substr(s, n + 1)
    }
    return times ? out "*" times : out
}

# Parts of a list with commas, each in the unit of its place: `first`, then `rest`.
function list(s, first, rest,    out, part, n, depth, name, unit) {
    unit = first
    for (s = s ","; s != ""; s = substr(s, n + 1)) {
        n = token(s)
        name = substr(s, 1, n)
        depth += (name ~ /^[(\[]$/) - (name ~ /^[)\]]$/)
        if (name != "," || depth) {
            part = part name
            continue
        }
        out = out (out == "" ? "" : ", ") "(" trim(part) ")*" unit
        part = ""
        unit = rest
    }
    return out
}

function start(name, value,    base, unit, period) {
    base = name
    sub(/\[.*/, "", base)
    if (match(value, /;[ \t]*period/)) {
        period = " ; period (" trim(substr(value, RSTART + RLENGTH)) ")*u_L"
        value = substr(value, 1, RSTART - 1)
    }
    if (base in coordinate)
        return list(value, "u_L", name ~ /\[[0-9]/ ? "u_L" : "u_P") period
    return list(value, base ~ /^p_/ ? "u_P" : "u_L/u_T", base ~ /^p_/ ? "u_P" : "u_L/u_T")
}

# Steps of differences, of all coordinates and momenta or of each.
function steps(value,    out, n, part, i, base, name) {
    if (value !~ /:/) {
        for (name in coordinate)
            out = out (out == "" ? "" : ", ") name ": " value "*u_L, p_" name ": " value "*u_P"
        return out
    }
    n = split(value, part, /,/)
    for (i = 1; i <= n; i++) {
        base = trim(part[i])
        out = out (i == 1 ? "" : ", ") base (base ~ /^p_/ ? "*u_P" : "*u_L")
    }
    return out
}

FNR == 1 { pass++ }
{
    sub(/[ \t]*#.*/, "")
    if ($0 ~ /^[ \t]*$/)
        next
}
/^\[/ { section = $1 }
pass == 1 {
    if (section == "[coordinates]" && $0 !~ /^\[/) {
        name = $1
        sub(/\[.*/, "", name)
        if (name !~ /^[pv]_/)
            coordinate[name] = 1
    }
    next
}
few && section == "[run]" && $1 ~ /^(integrators|t_end)$/ { next }
!told { told = 1; printf "[parameters]\n%s", units }
section ~ /^\[(labels|observables|picture|sections|ensemble)\]$/ { next }
/^\[/ { print; next }
{
    at = index($0, " =")
    while (section == "[coordinates]" && substr($0, 1, at) ~ /\[[^\]]*$/)
        at += index(substr($0, at + 2), " =") + 1
    name = trim(substr($0, 1, at - 1))
    value = trim(substr($0, at + 2))
    if (section == "[coordinates]")
        value = start(name, value)
    else if (section == "[effects]")
        value = formula(value, "u_E")
    else if (section ~ /^\[(definitions|invariants)\]$/)
        value = formula(value)
    else if (section == "[friction]")
        value = value "/u_T"
    else if (section == "[run]" && name ~ /^(dt|t_end|t_start)$/) {
        if (name == "dt" && few) {
            sub(/,.*/, "", value)
            print "t_end = (" (late == "" ? 0 : late) ")*u_T + " few "*(" value ")*u_T"
        }
        late = name == "t_start" ? value : late
        value = list(value, "u_T", "u_T")
    }
    else if (section == "[run]" && name == "transform")
        value = formula(value)
    else if (section == "[run]" && name == "gradient_step")
        value = steps(value)
    print name " = " value
}

#!/bin/sh
# The shared library defines what the headers declare NEVH_API, and no name
# but nevh_*.  nevh__* are shared inside and must not be seen.  The C reference
# describes all of it.

srcdir=${srcdir:-.}
work=symbols.$$
trap 'rm -rf $work' EXIT
trap 'exit 1' HUP INT TERM
mkdir $work || exit 1

# The name is the first one before a parenthesis, or else the last one.
for header in "$srcdir"/include/nevh/*.h; do
    sed '/^ *#/d; /\\$/d' "$header"
done | tr '\n' ' ' | awk '
    { n = split($0, part, /NEVH_API/)
      for (i = 2; i <= n; i++) {
          text = part[i]
          sub(/;.*/, "", text)
          gsub(/\[[^]]*\]/, "", text)
          if (match(text, /nevh_[a-z0-9_]* *\(/)) {
              name = substr(text, RSTART, RLENGTH - 1)
              gsub(/ /, "", name)
          } else {
              m = split(text, word, /[^a-z0-9_]+/)
              name = word[m] == "" ? word[m - 1] : word[m]
          }
          print name
      }
    }' | sort -u >$work/declared

status=0
# The C reference has an entry for each.
for name in $(cat $work/declared); do
    for form in "$srcdir/doc/reference.texi:^@def.* $name( |\$)" \
        "$srcdir/doc/nevh.3:^\.B \".*$name"; do
        grep -Eq "${form#*:}" "${form%%:*}" && continue
        echo "${form%%:*} has no $name"
        status=1
    done
done
# Those that take an object are called with NULL in tests/robust/check_null.c; a
# kernel is never called without its work.
objects='energy|rates|field|probe|reference|state_error|stepper|scene|sections'
objects="$objects|system|integrator|gradient|ensemble|sweep|loop|chaos|shadow"
for name in $(grep -E "^nevh_($objects)_" $work/declared); do
    case $name in
    nevh_*_named | nevh_system_from | nevh_scene_read* | nevh_scene_parse) ;;
    nevh_system_new | nevh_energy_verdict) ;; # a report
    *) grep -q "[ (]$name," "$srcdir/tests/robust/check_null.c" || {
        echo "tests/robust/check_null.c does not call $name with NULL"
        status=1
    } ;;
    esac
done
test $status = 0 || exit 1

nm=${NM:-nm}
lib=
for name in .libs/libnevh.so .libs/libnevh.dylib; do
    test -f $name && lib=$name
done
test -n "$lib" || { echo "there is no shared library here"; exit 77; }
# Unquoted: $NM may bring options of its own.
$nm --version >/dev/null 2>&1 || { echo "there is no nm"; exit 77; }

# Under sanitizers the compiler adds names; linkers add the others.
case $lib in
*.so) $nm -D --defined-only $lib | awk '{ print $NF }' ;;
*) $nm -g $lib | awk '$2 != "U" && NF == 3 { sub(/^_/, "", $3); print $3 }' ;;
esac | sed 's/@.*//; s/^_ZGV[b-e]N[248]vv*_//' |
    grep -Ev '^(__odr_asan.*|_init|_fini|__bss_start|_edata|_end)$' |
    sort -u >$work/defined

if ! test -s $work/defined || ! test -s $work/declared; then
    echo "found no symbols, or no declarations"
    status=1
fi
if grep -E -v '^nevh_[^_]' $work/defined >$work/strange; then
    echo "defined, but not a public name of nevh:"
    cat $work/strange
    status=1
fi
comm -13 $work/defined $work/declared >$work/missing
if test -s $work/missing; then
    echo "declared NEVH_API, but not in $lib:"
    cat $work/missing
    status=1
fi
comm -23 $work/defined $work/declared >$work/undeclared
if test -s $work/undeclared; then
    echo "in $lib, but declared NEVH_API in no installed header:"
    cat $work/undeclared
    status=1
fi
echo "$(wc -l <$work/declared) declared, $(wc -l <$work/defined) defined"
exit $status

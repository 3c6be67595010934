#!/bin/sh
# quickstart: what it installs, that it compiles once, what it shows.  The
# tools that it runs are stand-ins, so that nothing is installed or compiled.

srcdir=${srcdir:-.}
command -v bash >/dev/null 2>&1 ||
    { echo "quickstart: there is no bash"; exit 77; }
here=$(pwd -P)
work=$here/quickstart.$$
trap 'rm -rf "$work"' EXIT
trap 'exit 1' HUP INT TERM
mkdir -p "$work/bin" "$work/clone/build-aux" || exit 1

status=0
fails() {
    echo "quickstart: $1"
    cat "$work/out" "$work/err" "$work/done"
    status=1
}

# Nothing is found but these.
for tool in bash sh env sed cut tr mkdir rm cp mktemp dirname basename cat tail \
    head grep tee touch chmod readlink; do
    ln -s "$(command -v $tool)" "$work/bin/$tool" || exit 1
done
ln -s "$(command -v "${MAKE:-make}")" "$work/bin/make"
stub() {
    cat >"$work/bin/$1"
    chmod +x "$work/bin/$1"
}
stub nproc <<'EOF'
echo 1
EOF
stub id <<EOF
cat "$work/user"
EOF
stub cc <<'EOF'
while [ "$1" != -o ]; do shift; done
printf '#!/bin/sh\n' >"$2"
chmod +x "$2"
EOF
# Of modules, those named in a file are there.
stub pkg-config <<EOF
case \$1 in
--exists) grep -q "^\${2%% *}\$" "$work/modules" ;;
*) grep -q "^\$2\$" "$work/modules" && echo 9.9 ;;
esac
EOF
stub apt-get <<EOF
echo "apt-get \$*" >>"$work/done"
for package; do
    case \$package in
    libgsl-dev) echo gsl ;;
    libmuparser-dev) echo muparser ;;
    check) echo check ;;
    gnuplot-nox) touch "$work/bin/gnuplot"; chmod +x "$work/bin/gnuplot" ;;
    texinfo) touch "$work/bin/makeinfo"; chmod +x "$work/bin/makeinfo" ;;
    help2man) touch "$work/bin/help2man"; chmod +x "$work/bin/help2man" ;;
    esac
done >>"$work/modules"
EOF

# A tarball of three files and two tests.
cp "$srcdir/quickstart" "$srcdir/nevh" "$work/clone/" || exit 1
touch "$work/clone/Makefile.in" "$work/clone/config.h.in" \
    "$work/clone/build-aux/ltmain.sh"
cat >"$work/clone/configure" <<EOF
#!/bin/sh
echo configure >>"$work/done"
case "\$*" in *--enable-werror*) echo werror >>"$work/done" ;; esac
mkdir -p tools tests/x
cat >Makefile <<'END2'
TESTS = tests/x/a.sh tests/x/b.sh
all: one.o two.o tools/nevh
one.o two.o tests/x/a.o:
	@echo "  CC       \$@"; echo "compile \$@" >>"$work/done"; touch \$@
tools/nevh: one.o two.o
	@printf '#!/bin/sh\necho table of \$\$2\n' >\$@; chmod +x \$@
check: all tests/x/a.o
	@for t in \$(TESTS); do echo "PASS: \$\$t"; \\
	  echo ':test-result: PASS' >\$\${t%.sh}.trs; touch \$\${t%.sh}.log; done
count-tests:
	@set -- \$(TESTS); echo \$\$#
clean:
	@rm -f one.o two.o tests/x/a.o tools/nevh; echo clean >>"$work/done"
END2
EOF
chmod +x "$work/clone/configure"

# exits STATUS ARGUMENT...: runs quickstart, with nothing in the environment.
exits() {
    expected=$1
    shift
    : >"$work/done"
    env -i PATH="$work/bin" $settings "$work/clone/quickstart" "$@" \
        >"$work/out" 2>"$work/err" </dev/null
    code=$?
    test $code = "$expected" || fails "exit status $code instead of $expected"
}
settings=
says() {
    grep -Eq -e "$1" "$work/err" || fails "does not say '$1'"
}
has() {
    grep -Eq -e "$1" "$work/out" || fails "lacks '$1'"
}
did() {
    grep -Eq -e "$1" "$work/done" || fails "did not: $1"
}
never() {
    grep -Eq -e "$1" "$work/done" && fails "did: $1"
}

# Who cannot install is told what to install.
echo 1000 >"$work/user"
: >"$work/modules"
exits 1
says 'apt-get install libgsl-dev'
never apt-get

# What is missing and what is wanted come at once, before the first build.
echo 0 >"$work/user"
exits 0
did '^apt-get .* install libgsl-dev gnuplot-nox check texinfo help2man libmuparser-dev$'
did 'compile one.o'
never werror # a warning of a newer compiler
says 'configured in [0-9]+ s'
says 'compiling: 2 of 2$'
says 'compiling: 2 files in [0-9]+ s'
has '^table of pendulum$'
has '^table of double-pendulum$'
has '^  \./nevh '

# The tests find that build as it is.
exits 0 check
never 'clean|configure|apt-get|compile (one|two)\.o'
did 'compile tests/x/a\.o'
says 'tests: 2 of 2$'
test "$(tail -n 1 "$work/out")" = '2 passed, 0 failed, 0 skipped' ||
    fails 'has another last line'
exits 0
test -s "$work/done" && fails 'did something again'

# Other flags need other objects; a library of tests does not.
settings=CFLAGS=-O1
exits 0
did '^configure$'
did '^clean$'
did 'compile one\.o'
grep -v '^check$' "$work/modules" >"$work/fewer"
cp "$work/fewer" "$work/modules"
echo 1000 >"$work/user"
exits 0
did '^configure$'
never 'clean|compile'

# Without gnuplot, and without a way to install it, all but plots other than SVG works.
rm "$work/bin/gnuplot"
exits 0
says 'without gnuplot: --plot takes FILE.svg alone'
never apt-get
has '^table of pendulum$'

# Without a compiler for WebAssembly, one line tells what the live page needs; tarballs
# have it.
mkdir -p "$work/clone/web"
echo 'page_packages = clang lld' >"$work/clone/web/local.mk"
echo 'S["HAVE_KIT_TRUE"]="#"' >"$work/clone/build/config.status"
exits 0
says '^quickstart: without nevh page; for it: apt-get install clang lld$'
touch "$work/clone/web/kit.html"
exits 0
grep -q 'nevh page' "$work/err" && fails 'asks for what is there'
exit $status

#!/bin/sh
# What bash completes for nevh.

srcdir=${srcdir:-.}
command -v bash >/dev/null 2>&1 ||
    { echo "completion: there is no bash"; exit 77; }
NEVH_SCENES=$srcdir/scenes
export NEVH_SCENES

# completes 'WORDS' 'WANTED': of the last of the words.
status=0
completes() {
    found=$(bash -c '
        . "$1"
        eval "COMP_WORDS=($2)"
        COMP_WORDS[0]=$3
        COMP_CWORD=$((${#COMP_WORDS[@]} - 1))
        _nevh
        echo "${COMPREPLY[*]}"' bash "$srcdir/tools/completion/nevh" \
        "$1" "${NEVH:-./tools/nevh}")
    case " $found " in
    *" $2 "*) ;;
    *)
        echo "completion: '$1' gives '$found', not '$2'"
        status=1
        ;;
    esac
}

completes 'nevh compa' compare
completes 'nevh help comp' compare
completes 'nevh compare --outp' --output
completes 'nevh run pendulum --star' --start
completes 'nevh list grad' gradients
completes 'nevh compare pendulum-s' pendulum-small
completes 'nevh compare pendulum --integr' --integrators
completes 'nevh list --a' --all
completes 'nevh compare pendulum --integrators verlet,gauss2' verlet,gauss20
completes 'nevh compare pendulum --format j' json
completes 'nevh run pendulum --plot-kind conf' configuration
completes 'nevh new x.nevh --from kepler-' kepler-0.9
completes 'nevh swe' sweep
completes 'nevh sweep pendulum --outcomes state,peri' state,period
completes 'nevh sweep pendulum --outcomes freq' 'frequency('
completes 'nevh compare --quiet keple' 'kepler-0.9 kepler'

# Names that a shell would run, expand or divide are names, of scenes, files, folders
# and all that nevh lists.
completion=$(cd "$srcdir/tools/completion" && pwd)/nevh
real=${NEVH:-./tools/nevh}
real=$(cd "${real%/*}" && pwd)/${real##*/}
work=$PWD/completion.$$
trap 'rm -rf "$work"' EXIT
trap 'exit 1' HUP INT TERM
mkdir "$work" "$work/scenes" "$work/here" "$work/folders" || exit 1
cd "$work" || exit 1
cat >names <<'END'
$(touch X)
`touch X`
a b; touch X
*
[a-z]?
~
$HOME
{one,two}
<(touch X)
a"b
a'b
a\b
a,b
"a",b
=1+1
@SUM(1)
!!
tail$(touch X)
END
while IFS= read -r name; do
    : >"scenes/$name.nevh"
    : >"here/$name.nevh"
    mkdir "folders/$name"
done <names
NEVH_SCENES=$work/scenes
cat >nevh <<END # lists them as integrators
#!/bin/sh
case \$* in *--help) exec "$real" "\$@" ;; esac
echo names
sed 's/,/;/g; /^"/ { s/"/""/g; s/.*/"&"/; }' "$work/names"
END
chmod +x nevh

# offers FILE FOLDER NEVH WORD...: of the last word the lines of FILE.
offers() {
    wanted=$1
    (
        cd "$2" || exit
        shift 2
        bash -c '
            . "$1"
            shift
            COMP_WORDS=("$@")
            COMP_CWORD=$(($# - 1))
            _nevh
            printf "%s\n" "${COMPREPLY[@]}"' bash "$completion" "$@" |
            sort -u >"$work/found"
    )
    shift 3
    sort -u "$wanted" >wanted
    diff wanted found ||
        { echo "completion: of 'nevh $*' it offers these names"; status=1; }
    test -z "$(find . -name X)" ||
        { echo "completion: 'nevh $*' runs a name"; status=1; }
    find . -name X -exec rm {} +
}
grep -v '[$`]' names >scenes_of
sed 's/$/.nevh/' names | cat scenes_of - >operands
grep '^a' names >of_a
printf '%s\n' 'a\b' >of_backslash
sed -n '/^a/p; s/^a/x,a/p' names | grep '^x' | tr , ';' | sed 's/;/,/' >last
for command in compare run; do
    offers operands here "$real" $command ''
    offers names folders "$real" $command ''
    offers of_a folders "$real" $command a
    offers of_backslash . "$real" $command 'a\\'
done
offers scenes_of . "$real" new x.nevh --from ''
offers names folders "$real" run x -o ''
tr , ';' <names >listed
offers listed . "$work/nevh" compare x --integrators ''
offers listed . "$work/nevh" compare x --gradient ''
echo >none # what is typed is no program either
offers none . "$real" run '--x//;e touch X;s/' x
offers last . "$work/nevh" compare x --integrators x,a
exit $status

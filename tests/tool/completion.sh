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
completes 'nevh compare --quiet keple' 'kepler-0.9 kepler'
exit $status

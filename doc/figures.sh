#!/bin/sh
# figures.sh SRCDIR NEVH: makes anew what the manual quotes, in SRCDIR/doc.
# Milliseconds are those of the machine, and of what else it does.

srcdir=$1 nevh=$2
NEVH_SCENES=$srcdir/scenes
export NEVH_SCENES

# quote FILE ARGUMENT...: what nevh prints, below the command.
quote() {
    file=$srcdir/doc/$1
    shift
    echo "nevh $*"
    { echo "\$ nevh $*" && $nevh "$@" 2>&1; } >"$file.new"
    mv "$file.new" "$file"
}

quote compare-pendulum.txt compare pendulum

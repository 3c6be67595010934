# To be sourced: $nevh, the command just built, without libtool's script where its
# library can be found: the script takes ten times as long as a short command, and would
# be interrupted, too.

nevh=${NEVH:-./tools/nevh}
if test -z "$NEVH" && LD_LIBRARY_PATH=$PWD/.libs ./tools/.libs/nevh --version \
    >/dev/null 2>&1; then
    LD_LIBRARY_PATH=$PWD/.libs${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}
    export LD_LIBRARY_PATH
    nevh=./tools/.libs/nevh
fi

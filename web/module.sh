#!/bin/sh
# The live page's module: the library for WebAssembly.
#
#   module.sh SRCDIR FOLDER OUT SOURCE...
#
# SOURCE are those of the library, from SRCDIR; FOLDER is for objects; OUT is the
# module.  CC is clang, AR llvm-ar, GSL_INCLUDE the folder that has gsl/,
# WASM_SYSROOT the one with include/wasm32-wasi.  What does not compile for the
# target is left out, and said where the module needs it.

srcdir=$1
folder=$2
out=$3
shift 3
: "${CC:=clang}" "${AR:=llvm-ar}" "${WASM_SYSROOT:=/usr}"

mkdir -p "$folder/include" || exit 1
rm -f "$folder"/*.o "$folder"/*.a "$folder/include/gsl"
ln -s "$GSL_INCLUDE/gsl" "$folder/include/gsl" || exit 1

# Functions that orbits spend their time in are compiled for speed, the others
# for size, where steps do not come in one copy for each number of stages.
small='-Oz -Dalways_inline=unused'
compile() {
    object=$folder/$(echo "$1" | tr / _).o
    case $1 in
    lib/expression/tape_gradient.c|lib/expression/tape_complex.c) how=$small ;;
    lib/expression/tape_*|lib/gradient/*_block.c|lib/gradient/*_point.c) how=-O2 ;;
    integrators/kernels/splitting_kernel.c) how='-Os -Dalways_inline=unused' ;;
    lib/gradient/*_stencil.c) how=-O2 ;;
    lib/work/*|lib/run/stepper.c|lib/run/run.c) how=-O2 ;;
    *) how=$small ;;
    esac
    $CC --target=wasm32-wasi --sysroot="$WASM_SYSROOT" -flto $how -std=c11 \
        -ffp-contract=off -ffunction-sections -fdata-sections \
        -DNDEBUG -DNEVH_PORTABLE -D_GNU_SOURCE -D_WASI_EMULATED_SIGNAL \
        -isystem "$folder/include" -I"$srcdir/include" -I"$srcdir/lib" \
        -I"$srcdir/integrators" -I"$srcdir/web" -I"$srcdir/tools/report" \
        -c "$srcdir/$1" -o "$object" 2>"$object.log"
}

objects=
out_of_it=
for source in "$@"; do
    case $source in
    *.h|lib/native/*|lib/scene/code.c|integrators/kernels/gsl_kernel.c|\
    integrators/kernels/tao_*) ;;
    *.c)
        if compile "$source"; then
            objects="$objects $object"
        else
            out_of_it="$out_of_it $source"
        fi
        ;;
    esac
done

# The module's own come whole; of the library what they need.
own=
for source in web/page web/describe web/pace web/crossing web/roots web/pair web/absent \
    web/absent_code web/math tools/report/lesson; do
    compile $source.c || { cat "$object.log"; exit 1; }
    own="$own $object"
done
$AR rc "$folder/library.a" $objects || exit 1
$CC --target=wasm32-wasi --sysroot="$WASM_SYSROOT" -mexec-model=reactor -O2 -flto \
    $own "$folder/library.a" -o "$out" -Wl,--gc-sections,--strip-all,--compress-relocations,--lto-O1 \
    -Wl,-z,stack-size=1048576 -Wl,--global-base=1024 -Wl,--max-memory=536870912 2>"$folder/link.log"
linked=$?
# Smaller by 4 %, where binaryen is.  Nothing stands below the global base.
if test $linked = 0 && command -v wasm-opt >/dev/null 2>&1; then
    wasm-opt -Oz --converge --low-memory-unused "$out" -o "$out.small" 2>>"$folder/link.log" &&
        mv "$out.small" "$out"
    rm -f "$out.small"
fi
test $linked = 0 || {
    cat "$folder/link.log"
    echo "sources that did not compile:$out_of_it"
}
exit $linked

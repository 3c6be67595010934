#!/bin/sh
# bench/walk.sh FOLDER: the commands from nothing to a table, a scene of one's own, a
# live page, a report and a notebook, with the seconds that each takes: from a clone in
# a bare Debian 12, then from the portable folder in a bare Debian 13, as a user, without
# a compiler.  Needs root, debootstrap, git and a network; FOLDER keeps the two systems.
set -eu
here=$(cd "$(dirname "$0")/.." && pwd)
mkdir -p "$1"
folder=$(cd "$1" && pwd)

root=
leave() {
    test -z "$root" || ! test -e "$root/proc/self" || umount "$root/proc"
}
trap leave EXIT
trap 'exit 1' HUP INT TERM

bare() {
    leave
    root=$folder/$1
    if ! test -e "$root/.bare"; then
        rm -rf "$root"
        echo "debootstrap --variant=minbase $1" >&2
        debootstrap --variant=minbase "$1" "$root" >"$folder/$1.log" 2>&1
        touch "$root/.bare"
    fi
    mount -t proc proc "$root/proc"
    echo
    echo "$(. "$root/etc/os-release" && echo "$PRETTY_NAME"), load $(cut -d ' ' -f 1 /proc/loadavg)"
}

# timed AS IN COMMAND: one line of the table; what the command prints is in a file.
timed() {
    began=$(date +%s.%N)
    chroot --userspec="$1" "$root" /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin \
        HOME="$2" LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive \
        sh -c "cd $2 && $3" >"$root/out" 2>&1 </dev/null ||
        { echo "failed: $3"; tail -n 30 "$root/out" | cut -c 1-300; exit 1; }
    echo "$began $(date +%s.%N)" | awk '{ printf "%7.1f s  ", $2 - $1 }'
    echo "$3"
}
made() {
    for file; do
        test -s "$root/$file" || { echo "there is no $file"; exit 1; }
    done
}
# all AS IN COMMAND: what is done with the command nevh.
all() {
    timed "$1" "$2" "$3 compare pendulum"
    grep -q 'verlet .*bounded' "$root/out"
    timed "$1" "$2" "$3 new own && $3 compare own.nevh"
    grep -q bounded "$root/out"
    timed "$1" "$2" "$3 page own.nevh -o page.html"
    timed "$1" "$2" "$3 report own.nevh -o report.html"
    made "$2/page.html" "$2/report.html"
}
packages='apt-get install -qq --no-install-recommends'
notebook='jupyter nbconvert --to html --execute --output-dir .'

bare bookworm
rm -rf "$root/nevh"
git clone -q "$here" "$root/nevh"
timed 0:0 /nevh 'apt-get update -qq'
timed 0:0 /nevh ./quickstart
timed 0:0 /nevh "$packages clang lld llvm wasi-libc libclang-rt-dev-wasm32 zopfli binaryen"
timed 0:0 /nevh '(cd build && ./config.status --recheck && ./config.status) && make -C build page'
all 0:0 /nevh ./nevh
timed 0:0 /nevh "$packages jupyter-nbconvert python3-ipykernel"
timed 0:0 /nevh "PYTHONPATH=python $notebook python/who-keeps-the-energy.ipynb"
made nevh/who-keeps-the-energy.html
timed 0:0 /nevh 'make -C build portable'
portable=$(echo "$root"/nevh/build/nevh-*-portable.tar.gz)

bare trixie
rm -rf "$root/home/student"
mkdir "$root/home/student"
cp "$portable" "$root/home/student"
chown -R 1000:1000 "$root/home/student"
timed 0:0 / "apt-get update -qq && $packages jupyter-nbconvert python3-ipykernel"
chroot "$root" sh -c '! command -v cc gcc clang' || { echo "there is a compiler"; exit 1; }
timed 1000:1000 /home/student 'tar -xzf nevh-*-portable.tar.gz && mv nevh-*-portable nevh'
all 1000:1000 /home/student nevh/bin/nevh
timed 1000:1000 /home/student \
    "PYTHONPATH=nevh/share/nevh/python $notebook nevh/share/nevh/python/who-keeps-the-energy.ipynb"
made home/student/who-keeps-the-energy.html
